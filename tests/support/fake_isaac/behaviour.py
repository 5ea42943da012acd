"""What every function of the stand-in does, one method for each: `do_Class_method`, `do_function`."""

import signal
import sys
import types
import warnings
from importlib import import_module
from pathlib import Path

import numpy as np

from support.fake_isaac.refused import Refused
from support.fake_isaac.robot_behaviour import RobotBehaviour
from trundle.sim.footprint import FootprintChecker
from trundle.worlds import World
from trundle.worlds.usd.options import NAME


class Behaviour(RobotBehaviour):
    """The state of Isaac Sim, and how calls change it."""

    # The application.

    @property
    def runs(self):
        return self.app_starts > self.app_closes

    def do_SimulationApp_new(self, app, launch_config, experience):
        if self.app_starts:
            raise Refused("Kit starts once in a process")
        self.app_starts += 1
        self.window_open = True
        self.launch = (launch_config, experience)
        signal.signal(signal.SIGINT, lambda *_: sys.exit(0))
        # Kit brings its own USD, which is not there before.
        sys.path += [] if self.kit_path is None else [str(self.kit_path)]
        names = ("Sdf", "Usd", "UsdGeom", "UsdPhysics")
        self.pxr = types.SimpleNamespace(**{name: import_module(f"pxr.{name}") for name in names})

    def do_SimulationApp_update(self, app):
        self._draw()

    def do_SimulationApp_close(self, app, wait_for_replicator, skip_cleanup):
        if self.runs:
            self.app_closes += 1

    def do_SimulationApp_is_running(self, app):
        return self.runs and self.window_open

    def do_SimulationApp_is_exiting(self, app):
        return not self.runs

    def do_get_assets_root_path(self, skip_check):
        if self.assets is None:
            raise RuntimeError("Could not find assets root folder: https://assets.example/Isaac/5.1")
        return str(self.assets)

    def _draw(self):
        if not self.window_open:
            raise Refused("drawing when the window was closed")
        self.draws += 1
        self.loading = max(0, self.loading - 1)
        self.on_draw(self.draws)

    # The stage.

    def do_open_stage(self, usd_path):
        if not self.pxr.Usd.Stage.IsSupportedFile(usd_path):
            raise ValueError("Only USD files can be loaded with this method")
        done = Path(usd_path).is_file()
        if done:
            # Reopened, as Kit does: what was added to an earlier stage of the same file is gone.
            root = self.pxr.Sdf.Layer.CreateAnonymous(".usda")
            root.TransferContent(self.pxr.Sdf.Layer.OpenAsAnonymous(usd_path))
            self.stage, self.stage_path, self.loading = self.pxr.Usd.Stage.Open(root), usd_path, 3
            self.timeline, self.body, self._solids = "stopped", None, None
        return done if self.generation == 5 else (done, self.stage)

    def do_add_reference_to_stage(self, usd_path, prim_path=None, path=None, prim_type="Xform", variants=None):
        if not Path(usd_path).is_file():
            raise FileNotFoundError(f"The usd file at path {usd_path} provided wasn't found")
        prim = self.stage.DefinePrim(prim_path or path, prim_type)
        prim.GetReferences().AddReference(usd_path)
        self.loading = 3
        return prim

    def do_is_stage_loading(self):
        return self.loading > 0

    def do_get_stage_units(self):
        meters = self.pxr.UsdGeom.GetStageMetersPerUnit(self.stage)
        return meters if self.generation == 5 else (meters, self.pxr.UsdPhysics.GetStageKilogramsPerUnit(self.stage))

    def do_get_stage_up_axis(self):
        return str(self.pxr.UsdGeom.GetStageUpAxis(self.stage))

    def do_get_context(self, name):
        return self._bare("omni.usd", "UsdContext")

    def do_UsdContext_get_stage(self, context):
        return self.stage

    def _bare(self, module, name):
        return object.__new__(self.modules[module][name])

    # Physics.

    def _need_playing(self, what):
        if self.timeline != "playing" or self.body is None or not self.body.valid:
            raise Refused(f"{what} when the timeline does not play")

    def _play(self):
        if self.loading:
            raise Refused("play while the stage is being loaded")
        self.timeline = "playing"
        if self.body is not None:
            self.body.start()

    def _stop(self):
        self.timeline = "stopped"
        self.view_valid = False
        if self.body is not None:
            self.body.valid = False

    def _step(self):
        self._need_playing("a step")
        self.steps += 1
        self.body.step(self.dt, self.floor)
        self.on_step(self.steps)

    def do_World_new(self, world, physics_dt, rendering_dt, stage_units_in_meters, **_):
        if self.world_exists:
            raise Refused("a second World before the first is cleared")
        if self.stage is None:
            raise Refused("a World without a stage")
        if physics_dt is None or not 0 < physics_dt <= rendering_dt:
            raise Refused(f"physics_dt {physics_dt}, rendering_dt {rendering_dt}")
        self.world_exists, self.dt = True, physics_dt

    def do_World_clear_instance(self):
        self.world_exists = False

    def do_World_reset(self, world, soft):
        self._stop()
        self._play()
        self.body.valid = False  # what is in no scene is not taken hold of

    def do_WheeledRobot_initialize(self, robot, physics_sim_view):
        if self.timeline != "playing":
            raise Refused("initialize before physics runs")
        self.body.valid = True

    def do_World_step(self, world, render, step_sim, update_fabric):
        if render:
            raise Refused("a step that draws does as many physics steps as its own clock says")
        self._step()

    def do_World_render(self, world):
        self._draw()

    def do_World_is_playing(self, world):
        return self.timeline == "playing"

    def do_World_is_stopped(self, world):
        return self.timeline == "stopped"

    def do_World_stop(self, world):
        self._stop()

    def do_set_camera_view(self, eye, target, camera_prim_path, viewport_api):
        self.cameras[camera_prim_path] = (tuple(eye), tuple(target))

    def do_SimulationManager_setup_simulation(self, dt, device):
        self.dt = dt

    def do_SimulationManager_step(self, steps, callback, update_fabric):
        for _ in range(steps):
            self._step()

    def do_RenderingManager_render(self):
        self._draw()

    def do_ViewportManager_set_camera_view(self, camera, eye, target, relative_tracking):
        self.cameras[camera] = (tuple(eye), tuple(target))

    def do_play(self, commit):
        self._play()

    def do_stop(self, commit):
        self._stop()

    def do_is_playing(self):
        return self.timeline == "playing"

    def do_is_stopped(self):
        return self.timeline == "stopped"

    def do_enable_extension(self, name, enabled):
        return name in self.modules or any(known.startswith(f"{name}.") for known in self.modules)

    # Contacts.

    def do_get_physx_simulation_interface(self):
        return self._bare("omni.physx", "IPhysxSimulation")

    def do_IPhysxSimulation_get_contact_report(self, interface):
        self._need_playing("a contact report")
        if not self.body.reports:
            return [], []
        self.paths, headers, points = [], [], []
        for own, other, position in self.body.contacts():
            self.paths += [own, other]
            names = {"actor0": len(self.paths) - 1, "collider0": len(self.paths) - 1}
            names |= {"actor1": len(self.paths) - 2, "collider1": len(self.paths) - 2}
            headers.append(
                types.SimpleNamespace(
                    type="ContactEventType.CONTACT_PERSIST",
                    contact_data_offset=len(points),
                    num_contact_data=1,
                    **names,
                )
            )
            points.append(types.SimpleNamespace(position=position))
        lost = dict.fromkeys(("actor0", "collider0", "actor1", "collider1"), 0)
        headers.append(
            types.SimpleNamespace(
                type="ContactEventType.CONTACT_LOST", contact_data_offset=0, num_contact_data=0, **lost
            )
        )
        return headers, points

    @property
    def solids(self):
        """The robot's prism against the solids of the open stage, and their prims; none in an empty one."""
        if self._solids is None:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                world = World.load(self.stage_path)
            prims = {prim.GetCustomDataByKey(NAME) or str(prim.GetPath()): prim for prim in self.stage.Traverse()}
            checker = FootprintChecker(world, self.robot) if world.solids else None
            self._solids = checker, {name: str(prim.GetPath()) for name, prim in prims.items()}
        return self._solids

    # Pictures.

    def do_render_product(self, camera, resolution):
        self.resolution = resolution
        return types.SimpleNamespace(path=f"/Render/{camera}", destroy=lambda: None)

    def do_AnnotatorRegistry_get_annotator(self, name):
        return self._bare("omni.replicator.core", "Annotator")

    def do_Annotator_attach(self, annotator, render_products):
        self.attached_at = self.draws

    def do_Annotator_detach(self, annotator):
        self.attached_at = None

    def do_Annotator_get_data(self, annotator):
        width, height = self.resolution
        if self.draws < self.attached_at + 5:
            return np.zeros(0, dtype=np.uint8)
        picture = np.zeros((height, width, 4), dtype=np.uint8)
        picture[:, :, 0] = np.linspace(0, 255, width)
        picture[:, :, 3] = 255
        return picture
