"""Step 3 of 5: drive it by hand through a differential controller.

A command is a forward speed v [m/s] and a turn rate w [rad/s], counter-clockwise. The differential drive converts it
into wheel speeds, and the simulator into motion.
"""

import trundle

robot = trundle.Robot.load("nova_carter")
floor = trundle.World(name="floor", solids=())

# The differential drive: two wheel speeds [rad/s] for a twist, clipped as by Isaac Sim's controller.
print("wheel speeds for 0.4 m/s driving straight:", robot.wheel_command(trundle.Twist2D(0.4, 0.0)))
print("wheel speeds for turning in place:", robot.wheel_command(trundle.Twist2D(0.0, 0.7)))

# One step is one control period. The simulator applies the robot's limits of speed and acceleration.
period = 0.05
with trundle.simulate(floor, robot, backend="mujoco") as sim:
    sim.reset(trundle.Pose2D(0.0, 0.0, 0.0))
    for v, w, seconds in [(0.4, 0.0, 5.0), (0.0, 0.7, 3.0), (0.25, -0.5, 4.0)]:
        for _ in range(round(seconds / period)):
            state = sim.step(trundle.Twist2D(v, w), period)
        x, y, yaw = state.pose.as_tuple()
        print(f"after {seconds:g} s of v={v:g}, w={w:g}: x {x:.3f} m, y {y:.3f} m, yaw {yaw:.3f} rad")
