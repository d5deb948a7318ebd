"""How fast it is: prints, and asserts nothing. Times are those of this process, so that other work on the machine counts little."""

import time
from collections.abc import Callable

import pt326

BEST_OF = 7


def seconds(what: Callable[[], object]) -> float:
    def once() -> float:
        begun = time.process_time()
        what()
        return time.process_time() - begun

    return min(once() for _ in range(BEST_OF))


def loop() -> None:
    rig, instrument = pt326.Rig("paper", faults=pt326.scenario()["fault"]), pt326.Instrument()
    instrument.arm()
    codes = rig.codes
    for _ in range(7727):
        power = instrument.control(codes)
        instrument.diagnose()
        codes = rig.step(power)


print(f"rig and instrument: {7727 / seconds(loop):,.0f} steps/s")
print(f"the paper's run:    {1e3 * seconds(pt326.run):.1f} ms")
