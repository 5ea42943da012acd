"""`AmclSettings`: every option of the localizer `amcl`, with Nav2's names where the meaning is the same."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, model_validator

from trundle.errors import InputError
from trundle.files.yaml_config import Angle, Config

Share = Annotated[float, Field(ge=0.0, le=1.0)]
Alpha = Annotated[float, Field(ge=0.0, le=10.0)]
Metres = Annotated[float, Field(gt=0.0, le=1e3)]


class AmclSettings(Config):
    """How the filter moves, weighs and draws its particles, and when it says that it does not know.

    None of them is needed for the common case.

    Attributes:
        min_particles: The fewest particles.
        max_particles: The most particles.
        alpha1: Variance of a turn per rad² that the odometry turned (Nav2's model of a differential drive).
        alpha2: Variance of a turn per m² that it drove.
        alpha3: Variance of a distance per m² that it drove.
        alpha4: Variance of a distance per rad² that it turned.
        alpha5: Of sideways motion, which a differential drive has none of; it is accepted and unused, as in Nav2.
        laser_max_range: The longest beams that are used [m]. If None, as long as each lidar measures.
        max_beams: The most beams of one update, over all lidars.
        z_hit: Share of beams that are expected to end on the map.
        z_rand: Share of beams that are expected to end anywhere.
        sigma_hit: Deviation of particles' beams from the map [m].
        pf_err: Largest error between the particles and what they stand for (KLD sampling).
        pf_z: Quantile that this error is kept with.
        update_min_d: Least distance between updates [m]; 0 uses every scan.
        update_min_a: Least turn between updates [rad]; 0 uses every scan.
        recovery: Whether the whole map is searched when the robot is lost.
        lost_below: Share of beams that agree with the map, on average over a second, below which the robot is lost.
        match_noise: Deviation of a beam from the map in scan matching [m], of lidar and map together. It is larger than
            the lidar's noise, because errors of the map repeat from scan to scan.
        map_error: What the map itself may be off by [m], added to the deviations of the estimate.
    """

    min_particles: Annotated[int, Field(ge=10, le=100_000)] = 500
    max_particles: Annotated[int, Field(ge=10, le=100_000)] = 2000
    alpha1: Alpha = 0.01
    alpha2: Alpha = 0.01
    alpha3: Alpha = 0.01
    alpha4: Alpha = 0.01
    alpha5: Alpha = 0.0
    laser_max_range: Metres | None = None
    max_beams: Annotated[int, Field(ge=10, le=10_000)] = 120
    z_hit: Share = 0.9
    z_rand: Share = 0.1
    sigma_hit: Annotated[float, Field(ge=0.005, le=10.0)] = 0.1
    pf_err: Annotated[float, Field(gt=0.0, le=1.0)] = 0.05
    pf_z: Annotated[float, Field(ge=0.0, le=10.0)] = 2.33
    update_min_d: Annotated[float, Field(ge=0.0, le=100.0)] = 0.0
    update_min_a: Annotated[Angle, Field(ge=0.0, le=10.0)] = 0.0
    recovery: bool = True
    lost_below: Share = 0.5
    match_noise: Annotated[float, Field(ge=0.002, le=10.0)] = 0.1
    map_error: Annotated[float, Field(ge=0.0, le=10.0)] = 0.012

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.min_particles > self.max_particles:
            raise InputError(
                f"min_particles {self.min_particles} is above max_particles {self.max_particles}; swap or correct them"
            )
        if self.z_hit + self.z_rand <= 0.0 or self.z_rand <= 0.0:
            raise InputError("z_rand must be above 0: a beam may always end anywhere; use 0.1")
        return self
