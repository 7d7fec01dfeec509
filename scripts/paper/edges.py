# SPDX-License-Identifier: Apache-2.0
"""Edges of a mesh as a picture of clray's sees them, for figures 2, 4 and 6: facets of equal brightness have none.

An edge is drawn where its two faces turn by more than 10 degrees, or where there is one face alone. Metres; pixels.
"""

import math

PIECE_M = 0.02  # an edge falls into pieces of this length, each visible or hidden
SMOOTH = math.cos(math.radians(10.0))


def minus(a, b):
    return tuple(x - y for x, y in zip(a, b))


def inner(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def read_faces(path):
    """Faces of an OBJ file as lists of corner indices, and the corners."""
    corners, faces = [], []
    with open(path, encoding="utf-8") as file:
        for line in file:
            words = line.split()
            if words[:1] == ["v"]:
                corners.append(tuple(float(word) for word in words[1:4]))
            elif words[:1] == ["f"]:
                faces.append([int(word.split("/")[0]) - 1 for word in words[1:]])
    return corners, faces


def normal_of(corners, face):
    n = cross(minus(corners[face[1]], corners[face[0]]), minus(corners[face[2]], corners[face[0]]))
    size = math.sqrt(inner(n, n))
    return tuple(x / size for x in n)


def sharp_edges(corners, faces, normals):
    sides = {}
    for i, face in enumerate(faces):
        for a, b in zip(face, face[1:] + face[:1]):
            sides.setdefault((min(a, b), max(a, b)), []).append(i)
    for edge, owners in sides.items():
        if len(owners) != 2 or inner(normals[owners[0]], normals[owners[1]]) < SMOOTH:
            yield edge, owners


def covers(polygon, point):
    """Whether a convex polygon of the picture plane has the point well inside."""
    turns = set()
    for a, b in zip(polygon, polygon[1:] + polygon[:1]):
        turn = (b[0] - a[0]) * (point[1] - a[1]) - (b[1] - a[1]) * (point[0] - a[0])
        if abs(turn) < 1e-9:
            return False
        turns.add(turn > 0.0)
    return len(turns) == 1


def visible_edges(path, view):
    """Line pieces ((x, y), (x, y)) in metres right and up; `view` is an orientation of the summary's rgb entry."""
    corners, faces = read_faces(path)
    normals = [normal_of(corners, face) for face in faces]
    flat = [(inner(c, view["right"]), inner(c, view["up"])) for c in corners]
    depth = [inner(c, view["toward"]) for c in corners]
    facing = [inner(normal, view["toward"]) for normal in normals]
    polygons = [[flat[c] for c in face] for face in faces]
    pieces = []
    for (a, b), owners in sharp_edges(corners, faces, normals):
        if len(owners) == 2 and max(facing[i] for i in owners) <= 1e-9:
            continue
        count = max(1, math.ceil(math.dist(corners[a], corners[b]) / PIECE_M))
        for k in range(count):
            s, t = k / count, (k + 1) / count
            middle = 0.5 * (s + t)
            point = tuple((1 - middle) * flat[a][i] + middle * flat[b][i] for i in (0, 1))
            near = (1 - middle) * depth[a] + middle * depth[b]
            if any(
                i not in owners
                and abs(facing[i]) > 1e-9
                and covers(polygons[i], point)
                and plane_depth(corners[faces[i][0]], normals[i], facing[i], point, view) > near + 1e-9
                for i in range(len(faces))
            ):
                continue
            ends = [tuple((1 - u) * flat[a][i] + u * flat[b][i] for i in (0, 1)) for u in (s, t)]
            if pieces and k > 0 and pieces[-1][1] == ends[0]:
                pieces[-1][1] = ends[1]
            else:
                pieces.append(ends)
    return pieces


def plane_depth(corner, normal, facing, point, view):
    """How near to the viewer a face's plane is at a point of the picture."""
    offset = inner(normal, corner) - point[0] * inner(normal, view["right"]) - point[1] * inner(normal, view["up"])
    return offset / facing
