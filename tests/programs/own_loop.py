import trundle

world = trundle.World.generate("warehouse")
navigator = trundle.Navigator(None, "nova_carter")
navigator.set_goal(4.0, 4.5)
with trundle.simulate(world, navigator.robot, backend="kinematic") as sim:
    state = sim.reset(trundle.Pose2D(2.0, 4.5))
    while navigator.status not in ("arrived", "stuck", "no_path"):
        state = sim.step(navigator.update(state.pose, state.twist), navigator.dt)
print(navigator.status, state.pose)
