"""What measuring a run on the world's solids costs, beside the run: python benchmarks/metrics.py"""

import time

from trundle.mission import Scenario
from trundle.mission.metrics import measure_truth
from trundle.worlds import world_names

print("| world | simulated s | run ms | measuring ms | driven m | shortest m | SPL | clearance m |")
print("| --- | --- | --- | --- | --- | --- | --- | --- |")
for name in world_names():
    with Scenario.make(world=name, seed=3).build() as mission:
        began = time.process_time()
        episode = mission.run()
        run_ms = 1e3 * (time.process_time() - began)
        ends = (episode.start.as_tuple(), *episode.goals)
        costs: list[float] = []
        for _ in range(5):
            began = time.process_time()
            measure_truth(
                episode.trajectory.poses,
                ends,
                mission.robot,
                mission.world,
                mission.navigator.costmap,
                arrived=episode.arrived,
                touched=bool(episode.metrics.contacts),
            )
            costs.append(1e3 * (time.process_time() - began))
    metrics = episode.metrics
    print(
        f"| {name} | {metrics.time_s:.1f} | {run_ms:.0f} | {min(costs):.1f} | {metrics.distance_m:.2f} "
        f"| {metrics.shortest_path_m or float('nan'):.2f} | {metrics.spl:.3f} | {metrics.min_clearance_m:.3f} |"
    )
