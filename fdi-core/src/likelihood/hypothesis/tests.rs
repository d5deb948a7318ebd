use super::super::evidence::MOST;
use super::super::posterior::Posterior;
use super::super::regressor::Regressor as C;
use super::*;

#[test]
fn the_magnitudes_have_the_units_of_their_classes() {
    for (h, row) in HYPOTHESES.iter().enumerate() {
        let unit = match row.first.direction {
            Direction::Of(C::Offset1 | C::Offset2) | Direction::Offset0 => "degC",
            Direction::Of(C::Ramp1 | C::Ramp2) | Direction::Ramp0 => "degC/min",
            Direction::Of(C::LessFlow | C::MoreFlow) => "% of air flow",
            Direction::Of(C::Power | C::Constant) => "% of power",
            Direction::Of(C::Gain1 | C::ShortLoss | C::LongLoss) | Direction::MidLoss => "% of gain",
            Direction::Of(C::Gain2) => "% of gain",
            Direction::Of(C::Exchanged) => "",
            other => panic!("{h}: {other:?} is no magnitude"),
        };
        let unsized_class = matches!(row.class, FaultClass::Stuck(_) | FaultClass::Swapped(_));
        assert!(
            unsized_class || row.class.unit() == unit,
            "{h}: {} is in {}",
            row.class.name(),
            row.class.unit()
        );
    }
}

/// A thermistor's class moves that thermistor's regressors and no other's.
#[test]
fn a_thermistors_hypothesis_moves_its_own_columns() {
    let first = [C::Offset1, C::Gain1, C::ShortLag, C::LongLag, C::ShortLoss, C::LongLoss, C::Ramp1];
    let second = [C::Offset2, C::Gain2, C::Ramp2];
    let both = [C::Exchanged];
    for (h, row) in HYPOTHESES.iter().enumerate() {
        let moved = |free: Prior| free.direction.regressors();
        let regressors = [Some(row.first), row.second].into_iter().flatten().flat_map(moved);
        let of = |list: &[C], regressor: usize| list.iter().any(|which| *which as usize == regressor);
        for regressor in regressors {
            let fits = match row.class.sensor() {
                Some(Channel::T1) => of(&first, regressor),
                Some(Channel::T2) => of(&second, regressor),
                Some(Channel::T0) => of(&[C::Offset1, C::Offset2, C::Ramp1, C::Ramp2], regressor),
                None if matches!(row.class, FaultClass::Drift | FaultClass::Swapped(_)) => {
                    [&first[..], &second, &both].into_iter().any(|list| of(list, regressor))
                }
                None => !of(&first, regressor) && !of(&second, regressor),
            };
            assert!(fits, "{h}: {} moves regressor {regressor}", row.class.name());
        }
    }
}

/// What is thought beforehand can be: each prior mean lies within its range or on its edge, and each spread is one.
#[test]
fn prior_means_are_possible() {
    for (h, row) in HYPOTHESES.iter().enumerate() {
        let (low, high) = row.range;
        assert!(low < high && (low..=high).contains(&row.first.mean), "{h}: {row:?}");
        assert!(
            [Some(row.first), row.second].into_iter().flatten().all(|free| free.sd > 0.0),
            "{h}: {row:?}"
        );
        assert!(row.prior <= 0.0, "{h}: none is commoner than the common ones");
        assert!(row.stuck_at.is_none_or(|m| m < 2 && row.second.is_some()), "{h}: {row:?}");
    }
}

/// Rows that share a magnitude's regressor share none of its values: a loss is either a clog or a thermistor that is out.
#[test]
fn a_loss_has_one_name() {
    for (h, row) in HYPOTHESES.iter().enumerate() {
        for (g, other) in HYPOTHESES[..h].iter().enumerate() {
            let same = row.first.direction == other.first.direction
                && row.second.map(|free| free.direction) == other.second.map(|free| free.direction);
            let apart = row.range.1 <= other.range.0 || other.range.1 <= row.range.0;
            assert!(!same || apart, "{g} and {h}");
        }
    }
}

#[test]
fn the_rows_that_are_told_apart_by_place_are_in_it() {
    // The tracker takes these over by place.
    for list in [&SINCE_ONSET[..], &SINCE_TRAINING[..]] {
        let directions = [of(C::Power), of(C::LessFlow), of(C::MoreFlow), of(C::Offset1), of(C::Offset2)];
        for (nuisance, direction) in list.iter().skip(2).zip(directions) {
            assert_eq!(nuisance.0, direction);
        }
        assert_eq!(list[1].0, of(C::Shift));
        assert_eq!(list.last().map(|last| last.0), Some(Direction::Offset0));
    }
}

/// No direction is a nuisance twice, all have a spread, and there is room for all of them.
#[test]
fn nuisances_are_listed_once() {
    for list in [&SINCE_ONSET[..], &SINCE_TRAINING, &MODEL_ERRORS] {
        assert!(list.len() <= MOST + 1, "and T0's");
        for (i, (direction, sd)) in list.iter().enumerate() {
            assert!(*sd > 0.0, "{direction:?}");
            assert!(list[..i].iter().all(|(other, _)| other != direction), "{direction:?}");
        }
    }
}

/// A wide prior is for what may be a fault: each nuisance is far narrower than the hypothesis of the same direction.
#[test]
fn a_nuisance_is_narrow_beside_its_fault() {
    for (direction, sd) in SINCE_ONSET.into_iter().chain(SINCE_TRAINING) {
        for row in HYPOTHESES.iter().filter(|row| row.first.direction == direction && row.first.mean == 0.0) {
            assert!(6.0 * sd < row.first.sd, "{direction:?}: {sd} beside {}", row.first.sd);
        }
    }
}

/// A size that it cannot have makes a hypothesis impossible, whatever it gains; no number does, too.
#[test]
fn impossible_sizes_gain_nothing() {
    let flow = HYPOTHESES.iter().find(|row| row.first.direction == of(C::LessFlow)).unwrap();
    let estimate = |value: f32| Estimate { gain: 100.0, value, ..Estimate::default() };
    assert_eq!(flow.judged(estimate(0.3)).gain, 100.0 + flow.prior);
    for value in [-0.01, 0.0, 5.0, f32::NAN] {
        assert_eq!(flow.judged(estimate(value)).gain, IMPOSSIBLE, "{value}");
    }
    let none: [Estimate; COUNT] = core::array::from_fn(|h| HYPOTHESES[h].judged(estimate(f32::NAN)));
    assert_eq!(Posterior::new(&none).best_gain, IMPOSSIBLE);
}

/// What a minute's means cannot tell apart is not asked of them; every common class is.
#[test]
fn the_common_classes_are_judged_over_minutes() {
    let lasting = |class: FaultClass| HYPOTHESES.iter().any(|row| row.class == class && row.lasting);
    let common = [FaultClass::T1Offset, FaultClass::T2Offset, FaultClass::T0Fault, FaultClass::T1Clogged];
    assert!(common.into_iter().chain([FaultClass::AirFlow, FaultClass::HeaterPower]).all(lasting));
    assert!(![FaultClass::Drift, FaultClass::T1Detached].into_iter().any(lasting));
}
