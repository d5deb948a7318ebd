from typing import Any

import numpy as np
import pytest

import pt326


@pytest.fixture(scope="module")
def samples() -> dict[str, Any]:
    run = pt326.run(seed=3)
    return {"t0": run["t0_c"], "t1": run["t1_c"], "t2": run["t2_c"], "power": run["pa_pct"]}


def test_it_is_called_as_a_detector_of_pyod_and_as_one_of_river(samples: dict[str, Any]) -> None:
    rows = np.column_stack(list(samples.values()))[:3800]
    scorer = pt326.Scorer()
    assert scorer.fit(rows[:3300]) is scorer
    scores = scorer.decision_function(rows[3300:])
    assert scores.dtype == np.float64
    wrong = slice(3500 - 3300, 3700 - 3300)  # T2 reads 1.5 degC too high from 384.5 to 409.5 s
    assert np.median(scores[wrong]) == pytest.approx(1.5, abs=0.4)
    assert np.median(scores[:190]) < 0.5
    alarmed = scorer.predict(rows[3300:])
    assert (alarmed[:190].sum(), alarmed[wrong].mean() > 0.9) == (0, True)
    one_by_one = [scorer.score_one(dict(zip(samples, row, strict=True))) for row in rows[3300:]]
    assert np.array_equal(scores, one_by_one), "decision_function has left no trace"


def test_it_takes_columns_and_samples_without_some(samples: dict[str, Any]) -> None:
    pandas = pytest.importorskip("pandas")
    some = {name: column[:3600] for name, column in samples.items()}
    first, last = ({name: column[part] for name, column in some.items()} for part in (slice(3300), slice(3300, None)))
    scorer = pt326.Scorer().fit(first)
    scores = scorer.decision_function(last)
    assert scores.max() > 1
    assert np.array_equal(scorer.decision_function(pandas.DataFrame(last)), scores)
    missing = dict(last, t2=np.full(300, np.nan))
    assert np.isfinite(scorer.decision_function(missing)).all()
    assert pt326.Scorer().score_one({"t1": 40.0, "power": 10.0}) == 0.0
