import math

import pytest

import pt326

board = pytest.importorskip("board", reason="there are no pseudo-terminals here")


def test_ticks_come_with_names_and_what_is_found() -> None:
    simulated = board.SimulatedBoard()
    with pt326.Board(simulated.port) as connected:
        assert (connected.port, connected.sample_time, connected.heat) == (simulated.port, 0.11, False)
        ticks = []
        for tick in connected:
            ticks.append(tick)
            if tick["class"] is not None:
                break
        assert connected.linked
        assert connected.settings["setpoint"] == 36.0
    found = ticks[-1]
    assert found["class"] == "t2_offset"
    assert found["t"] == pytest.approx(390.0, abs=1.0)
    assert (found["mode"], found["readiness"], found["trip"], found["setpoint"]) == ("monitor", "armed", None, 36.0)
    assert [round(tick["t"] / 0.11) for tick in ticks] == list(range(len(ticks)))
    assert not math.isnan(found["t1"])
    assert simulated.typed.startswith(b"\x15")
    assert not simulated.stopped.is_set(), "what it does by itself it goes on with"


def test_it_is_not_made_to_heat_unless_that_was_said() -> None:
    simulated = board.SimulatedBoard(ticks=50, armed=False)
    connected = pt326.Board(simulated.port)
    for line in ("arm", "tune start", "check", " arm"):
        with pytest.raises(pt326.Error, match="heat=True"):
            connected.ask(line)
    with pytest.raises(pt326.Error, match="heat=True"):
        connected.arm()
    assert connected.status().strip() == "ok"
    assert b"arm" not in simulated.typed
    assert b"check" not in simulated.typed


def test_with_heat_it_is_stopped_whatever_happens() -> None:
    simulated = board.SimulatedBoard(ticks=50, armed=False)
    with pytest.raises(ZeroDivisionError), pt326.Board(simulated.port, heat=True) as connected:
        connected.arm()
        assert b"arm\r" in simulated.typed
        assert not simulated.stopped.is_set()
        raise ZeroDivisionError
    assert simulated.stopped.wait(30)


def test_what_it_refuses_is_raised_and_silence_is_an_error() -> None:
    simulated = board.SimulatedBoard(ticks=20)
    connected = pt326.Board(simulated.port, patience=1.0)
    with pytest.raises(pt326.Error, match="the board says to `kettle`: unknown command"):
        connected.ask("kettle")
    with pytest.raises(pt326.Error, match="has said nothing for 1s"):
        for _ in connected:
            pass
    connected.stop()
    assert simulated.stopped.wait(30)


def test_a_port_that_there_is_not_is_refused() -> None:
    with pytest.raises(pt326.Error, match="cannot be opened"):
        pt326.Board("/dev/pt326-that-is-not-there")
