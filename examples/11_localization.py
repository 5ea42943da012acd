"""Watch a robot find out where it is: on bad odometry with `amcl`, carried away half-way, and then without `amcl`.

The page shows the true pose, and the estimate with its particles. --fast shows nothing and does not wait.
"""

import argparse
import time
import warnings
from contextlib import nullcontext

import trundle
from trundle.mission import GivenDirective, PlaceRobot, Scenario, Session

parser = argparse.ArgumentParser()
parser.add_argument("--fast", action="store_true")
fast = parser.parse_args().fast
warnings.filterwarnings("ignore", "the estimate was corrected")  # it is meant to jump when the robot is found

world = {"name": "warehouse", "seed": 3, "options": {"low_objects": False}}
mission_of = {"world": world, "start": (-12.0, 0.0, 0.0), "goal": (13.0, 4.0)}
odometry = {"scale": 0.01, "heading": "1deg"}
carried = (GivenDirective(240, 12.0, PlaceRobot(-9.0, -7.0, 1.57)),)  # after 240 control periods
for name, directives in (("amcl", carried), ("odometry", ())):
    scenario = Scenario.make(**mission_of, odometry=odometry, localizer=name, lidar=True, backend="kinematic", seed=1)
    with scenario.build() as mission, nullcontext() if fast else trundle.show(mission.world, mission.robot) as view:
        drive = mission.sim, mission.navigator, mission.start, mission.goals
        session = Session(*drive, localizer=name, seed=1, directives=directives, time_limit_s=70.0)
        said = ""
        while (step := session.step()) is not None:
            error = step.estimate.pose.distance_to(step.state.pose)
            if said != (said := step.estimate.state):
                print(f"{name}, {step.state.time:.1f} s: {said}, {error:.2f} m off")
            if view is not None:
                text = f"{name}: {said}, {error:.2f} m off. {step.message}"
                seen = {"scan": step.state.scans, "costmap": step.costmap, "estimate": step.estimate}
                view.update(step.state.pose, path=step.path, text=text, **seen)
                time.sleep(0.04)
        print(f"{name}: {session.finish().message}, {error:.2f} m off")
