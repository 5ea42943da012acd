"""NVIDIA's DifferentialControllers, 5.1's and 6's, on its published answers; prints one line of JSON."""

import json
import sys

from isaacsim import SimulationApp

simulation_app = SimulationApp({"headless": True})

from isaacsim.robot.experimental.wheeled_robots.controllers import DifferentialController as NewController  # noqa: E402
from isaacsim.robot.wheeled_robots.controllers.differential_controller import DifferentialController  # noqa: E402

answers = []
for limits, command in json.loads(sys.argv[1]):
    old = DifferentialController("jetbot", wheel_radius=0.03, wheel_base=0.1125, **limits).forward(command)
    new = NewController(wheel_radius=0.03, wheel_base=0.1125, **limits).forward(command)
    answers.append([list(map(float, old.joint_velocities)), list(map(float, new))])
print(json.dumps(answers))
