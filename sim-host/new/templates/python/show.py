"""Runs scenario.toml with the law and writes a page of the run: open run.html in a browser."""

import my_swarm
import staya

sim = staya.Simulation(my_swarm.SCENARIO, record=1)
my_swarm.run(sim)
sim.page().save("run.html")
print(f"{sim.time_s:.1f} s are in run.html")
