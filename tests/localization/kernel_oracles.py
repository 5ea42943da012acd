"""The kernels of localisation in NumPy, slow and plain."""

from __future__ import annotations

import math

import numpy as np
from scipy import optimize


def distance_field(occupied, resolution, shift, limit):
    rows, cols = occupied.shape
    out = np.empty((rows, cols))
    grid = np.stack(np.meshgrid(np.arange(rows), np.arange(cols), indexing="ij"), axis=-1).reshape(-1, 2)
    for row in range(rows):
        for col in range(cols):
            inside = bool(occupied[row, col])
            others = grid[(occupied.ravel() != 0) != inside]
            gaps = np.maximum(np.abs(others - (row, col)) - 0.5, 0.0)
            nearest = np.hypot(gaps[:, 0], gaps[:, 1]).min() if len(others) else np.inf
            out[row, col] = (-nearest if inside else nearest) * resolution
    return np.clip(out + shift, -limit, limit)


def field_at(field, resolution, limit, points):
    """Bilinear values, and slopes by the values a little to each side within the same square of centres."""
    out = []
    for x, y in points:
        u, v = x / resolution - 0.5, y / resolution - 0.5
        if not (0.0 <= u < field.shape[1] - 1 and 0.0 <= v < field.shape[0] - 1):
            out.append((limit, 0.0, 0.0))
            continue
        i, j = math.floor(u), math.floor(v)
        a, b, c, d = (float(field[j + k, i + m]) for k in (0, 1) for m in (0, 1))

        def value(s, t, a=a, b=b, c=c, d=d):
            return (1 - s) * (1 - t) * a + s * (1 - t) * b + (1 - s) * t * c + s * t * d

        s, t = u - i, v - j
        out.append((value(s, t), (value(1, t) - value(0, t)) / resolution, (value(s, 1) - value(s, 0)) / resolution))
    return np.array(out).reshape(-1, 3)


def pick_beams(ranges, angles, mount, poses, body, shortest, longest, most, offset):
    hits = [index for index, value in enumerate(ranges) if shortest <= value < longest]
    if len(hits) > most:
        hits = [hits[math.floor((k + offset) * (len(hits) / most))] for k in range(most)]
    points, sensors = [], []
    first, last = poses
    for index in hits:
        angle = angles[index] + mount[2]
        point = np.array((mount[0] + ranges[index] * math.cos(angle), mount[1] + ranges[index] * math.sin(angle)))
        if len(body) and (body[:, :2] @ point <= body[:, 2]).all():
            continue
        share = index / max(1, len(ranges) - 1)
        turned = math.remainder(last[2] - first[2], 2.0 * math.pi)
        pose = (*(first[:2] + share * (last[:2] - first[:2])), first[2] + share * turned)
        point, sensor = ends_of(np.array([point, mount[:2]]), pose)
        points.append(point)
        sensors.append(sensor)
    return np.array(points).reshape(-1, 2), np.array(sensors).reshape(-1, 2)


def _patches(field, resolution, limit, points, pose, shape, edge):
    """Row and column of the patch of each point, and its distance from the surface."""
    ends = ends_of(points, pose)
    slopes = field_at(field, resolution, limit, ends)
    feet = (ends - slopes[:, :1] * slopes[:, 1:]) / edge
    rows, cols = (np.clip(np.floor(feet[:, k]), 0, shape[1 - k] - 1).astype(int) for k in (1, 0))
    return rows, cols, slopes[:, 0]


def expect_surfaces(field, resolution, limit, points, pose, counts, means, edge, offset, settings):
    deepest, least, rise, believed, half_after = settings
    rows, cols, distances = _patches(field, resolution, limit, points, pose, counts.shape, edge)
    taken, apart = counts[rows, cols].astype(float), means[rows, cols].astype(float) - offset
    share = np.clip((np.abs(apart) - least) / rise, 0.0, 1.0)
    return offset + np.where(np.abs(distances) < deepest, believed * taken / (taken + half_after) * share * apart, 0.0)


def learn_surfaces(field, resolution, limit, points, pose, counts, means, edge, deepest, most):
    """Counts and means after it."""
    counts, means = counts.astype(float), means.astype(float)
    rows, cols, distances = _patches(field, resolution, limit, points, pose, counts.shape, edge)
    seen = {(row, col): at for row, col, at in zip(rows, cols, distances, strict=True) if abs(at) < deepest}
    for patch, distance in seen.items():
        counts[patch] = min(counts[patch] + 1.0, most)
        means[patch] += (distance - means[patch]) / counts[patch]
    return counts, means


def peak_particle(particles, weights, metres, radians):
    peak = particles[weights.argmax()]
    turned = np.array([math.remainder(yaw - peak[2], 2.0 * math.pi) for yaw in particles[:, 2]])
    near = (np.hypot(*(particles[:, :2] - peak[:2]).T) <= metres) & (np.abs(turned) <= radians)
    if weights[near].sum() == 0.0:
        return peak
    share = weights[near] / weights[near].sum()
    return np.array((*(share @ particles[near, :2]), peak[2] + share @ turned[near]))


def weigh_particles(table, resolution, outside, particles, points):
    sums = []
    for x, y, yaw in particles:
        total = 0.0
        for px, py in points:
            u = math.floor((x + math.cos(yaw) * px - math.sin(yaw) * py) / resolution)
            v = math.floor((y + math.sin(yaw) * px + math.cos(yaw) * py) / resolution)
            inside = 0 <= v < table.shape[0] and 0 <= u < table.shape[1]
            total += float(table[v, u]) if inside else outside
        sums.append(total)
    return np.array(sums)


def ends_of(points, pose):
    x, y, yaw = pose
    cos, sin = math.cos(yaw), math.sin(yaw)
    return np.column_stack([x + cos * points[:, 0] - sin * points[:, 1], y + sin * points[:, 0] + cos * points[:, 1]])


def best_pose(field, resolution, limit, points, targets, prior, information, noise, width, most):
    """Where the robust cost of a scan is least near a prior, by weights that are found again and again."""
    pose = np.array(prior)
    root = np.linalg.cholesky(information).T
    for _ in range(60):
        values = field_at(field, resolution, limit, ends_of(points, pose))[:, 0] - targets
        weights = (width**2 / (width**2 + values**2)) ** 2
        scale = min(1.0, most / weights.sum()) / noise**2

        def residuals(at, weights=weights, scale=scale):
            found = field_at(field, resolution, limit, ends_of(points, at))[:, 0] - targets
            return np.concatenate([np.sqrt(scale * weights) * found, root @ (at - prior)])

        after = optimize.least_squares(residuals, pose, method="lm", xtol=1e-12, ftol=1e-12).x
        if np.abs(after - pose).max() < 1e-9:
            break
        pose = after
    return pose


def judge_beam(field, resolution, sensor, point, pose, tolerance, depth):
    """As the kernel does, in steps of a tenth of a cell."""
    start, end = ends_of(np.array([sensor, point]), pose)
    inside = field_at(field, resolution, np.nan, end[np.newaxis])[0, 0]
    if np.isnan(inside):
        return 3
    length = float(np.hypot(*(end - start)))
    at = np.arange(0.0, max(0.0, length - depth), 0.1 * resolution)
    line = start + at[:, np.newaxis] * (end - start) / max(length, 1e-12)
    along = field_at(field, resolution, 1.0, line)[:, 0]
    if inside < -depth or (along <= 0.0).any():
        return 2
    return 0 if inside <= tolerance else 1


def score(table, resolution, points, col, row, yaw):
    """What the search scores a pose with: the mean of the table where the points lie."""
    cos, sin = math.cos(yaw), math.sin(yaw)
    total = 0
    for px, py in points:
        u = col + math.floor((cos * px - sin * py) / resolution + 0.5)
        v = row + math.floor((sin * px + cos * py) / resolution + 0.5)
        if 0 <= u < table.shape[1] and 0 <= v < table.shape[0]:
            total += int(table[v, u])
    return total / len(points)
