"""`RunningStage`: a stage in an engine of its own, which can start again and take further solids while it runs."""

from __future__ import annotations

import logging
import warnings
from typing import Any

from pxr import Usd

from trundle.errors import SimulationError, WorldError, WorldWarning
from trundle.geometry.solids import Solid
from trundle.guard.child import uncounted_growth
from trundle.sim.physx.attachment import Attachment
from trundle.sim.physx.engine import Messages, collected_messages, library, start_engine
from trundle.sim.physx.scene import ROBOT, Scene, report_contacts
from trundle.usd.stage import bind_friction, friction_material
from trundle.usd.world import FRICTION, add_solid

_log = logging.getLogger(__name__)

_SENSORS = f"{ROBOT}/**"


class RunningStage:
    """A stage that is simulated.

    Args:
        scene: The stage.

    Attributes:
        added: Names of the solids that were added since it began, by path.
        centre_of_mass: That of the articulation's root body [m], in its frame, shape (3,).

    Raises:
        InputError: If PhysX cannot run here.
        MissingExtraError: If it is not installed.
        WorldError: If it cannot simulate the stage.

    Warns:
        WorldWarning: If it refuses a part of it.
    """

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        # It reserves 3 GB of addresses, of which it uses a tenth; a worker of an evaluation may grow by 2 GB.
        with uncounted_growth():
            self._start()

    def _start(self) -> None:
        self._engine: Any = start_engine()
        self._ovstage = library("ovstage")
        self._population = self._ovstage.population
        self._stage: Any = None
        self._attachment: Attachment | None = None
        self._ordinal = 1
        self._handles: list[int] = []
        self.added: dict[str, str] = {}
        try:
            self._open()
        except BaseException:
            self.close()
            raise

    def _open(self) -> None:
        refused = Messages()
        try:
            with collected_messages(refused):
                self._stage = self._ovstage.Stage("trundle")
                domains = self._ovstage.PopulationDomain.PHYSICS
                self._population.open_usd(self._stage, str(self._scene.file), ordinal=1, domains=domains)
                self._stage.advance_write_floor(ordinal=1).wait()
                self._attach()
                self.centre_of_mass = self.attachment.centre_of_mass(self._scene.root)
        except (RuntimeError, ValueError, self._ovstage.OvstageError) as error:
            reason = refused.reason() or str(error)
            raise WorldError(f"{self._scene.source}: PhysX cannot simulate it: {reason}") from error
        if refused.refused:
            more = f" (and {len(refused.errors) - 1} more)" if len(refused.errors) > 1 else ""
            warnings.warn(
                f"{self._scene.source}: PhysX refuses a part of it, and the robot will pass through that: "
                f"{refused.told()}{more}",
                WorldWarning,
                stacklevel=4,
            )

    def _attach(self) -> None:
        scene = self._scene
        self._attachment = Attachment(
            self._engine,
            self._stage,
            self._ordinal,
            root=scene.root,
            wheels=scene.wheels,
            sensors=_SENSORS,
            movers=scene.movers,
        )

    @property
    def attachment(self) -> Attachment:
        """What is simulated now."""
        if self._attachment is None:
            raise SimulationError("this stage was closed")
        return self._attachment

    def begin(self) -> Attachment:
        """Start again, without what was added: the same commands give the same run to the last bit."""
        self.attachment.detach()
        if self._handles:
            for handle in reversed(self._handles):
                self._population.remove_usd(self._stage, handle)
            self._handles.clear()
            self.added.clear()
            self._seal()
        with collected_messages(Messages()):  # what is refused was told at the start
            self._attach()
        return self.attachment

    def add(self, solid: Solid) -> None:
        """Put a solid into the running stage.

        Raises:
            WorldError: If PhysX refuses it.
        """
        path = f"/trundle_added_{self._ordinal}"
        refused = Messages()
        with collected_messages(refused):
            self._handles.append(self._population.add_usd_reference_from_string(self._stage, _as_usd(solid), path))
            self._update()
        if refused.refused:
            # Nothing of it stays in the stage.
            self._population.remove_usd(self._stage, self._handles.pop())
            with collected_messages(Messages()):
                self._update()
            raise WorldError(f"PhysX refuses the solid {solid.name!r}: {refused.reason()}")
        self.added[path] = solid.name

    def _update(self) -> None:
        """Give the running simulation what was changed in the stage."""
        self._seal()
        self._engine.wait_task(self._engine.update_from_ovstage(self._ordinal, self._ordinal))

    def _seal(self) -> None:
        """Make a version of the stage of what was changed in its USD."""
        self._ordinal += 1
        self._population.apply_usd_changes(self._stage, ordinal=self._ordinal)
        self._stage.advance_write_floor(ordinal=self._ordinal).wait()

    def close(self) -> None:
        """Release the engine; twice does nothing."""
        attachment, self._attachment = self._attachment, None
        stage, self._stage = self._stage, None
        engine, self._engine = self._engine, None
        if attachment is not None:
            attachment.detach()
        if engine is not None:
            try:
                engine.destroy()
            except RuntimeError as error:
                # An exception's traceback keeps arrays of it alive; the end of the process releases it.
                _log.debug("PhysX is not released: %s", error)
        if stage is not None:
            stage.destroy()


def _as_usd(solid: Solid) -> str:
    """Return a stage with one solid that reports its contacts: the robot's bodies do so for the first solids only."""
    stage: Any = Usd.Stage.CreateInMemory()
    prim = add_solid(stage, "/solid", solid)
    stage.SetDefaultPrim(prim)
    bind_friction(prim, friction_material(stage, "/solid/material", FRICTION, lowest=False))
    report_contacts(prim)
    return stage.GetRootLayer().ExportToString()
