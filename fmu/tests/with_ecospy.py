"""Both FMUs connected in Ecos, a simulator for co-simulation; run by tools/try-fmu with the folder that cargo builds in.

Ecos steps all parts at once, so that each power reaches the rig a sample late. It connects by itself; nothing here carries numbers.
"""

import sys
from pathlib import Path

from ecospy import EcosLib, EcosSimulation, EcosSimulationStructure

FMUS = Path(sys.argv[1]) / "fmu"
TICKS = 7727  # 850 s
# Numbers of the paper's three faults in the log, by which `finding_number` names them.
PAPER = {2: "t2_offset", 3: "t1_clogged", 4: "air_flow"}


def main():
    EcosLib.set_log_level("warn")
    with EcosSimulationStructure() as structure:
        for part in "rig", "instrument":
            structure.add_model(part, FMUS / f"pt326_{part}.fmu")
        for code in "code_t0", "code_t1", "code_t2", "code_supply":
            structure.make_real_connection(f"rig::{code}", f"instrument::{code}")
        structure.make_real_connection("instrument::power", "rig::power")
        structure.add_parameter_set("paper", {"rig::scenario": "paper", "instrument::arm": True})
        with EcosSimulation(structure=structure, step_size=0.11) as simulation:
            simulation.init(parameter_set="paper")
            named = {}
            for _ in range(TICKS):
                simulation.step()
                named.setdefault(simulation.get_integer("instrument::finding_number"), simulation.get_time())
            simulation.terminate()
    told = ", ".join(f"{PAPER.get(number, number)} at {time:.2f} s" for number, time in named.items() if number)
    if not PAPER.keys() <= named.keys():
        sys.exit(f"try-fmu: not so: Ecos, both connected, names the paper's three faults; it named: {told}")
    print(f"ok: Ecos, both connected: {told}")


if __name__ == "__main__":
    main()
