import math
import time

import trundle

with trundle.show("maze", "jackal", open_browser=False) as view:
    for i in range(20):
        angle = 0.1 * i
        pose = trundle.Pose2D(3.0 * math.cos(angle), 3.0 * math.sin(angle), angle + math.pi / 2.0)
        if view.take_goal() is not None or "w" in view.keys:
            print("the page asks for something:", view.goal, view.keys)
        view.update(pose, path=[(pose.x, pose.y), (0.0, 0.0)], text=f"round and round, {angle:.1f} rad")
        time.sleep(0.05)
