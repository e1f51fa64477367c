"""Vertices that are split where values of corners differ, against a plain search by dictionaries; large files as streams."""

from __future__ import annotations

import unittest

import numpy as np
import numpy.typing as npt
from support import HEADER, StageTest

from abbe.usd import weld


class Welding(unittest.TestCase):
    def check(self, corners: list[int], points: int, *primvars: weld.Primvar) -> npt.NDArray[np.int64]:
        """Equal corners have one vertex, others have none in common. Returns the vertex of each corner."""
        held = np.asarray(corners, np.int32)
        vertex, point, corner = weld.weld(held, points, list(primvars))
        point = np.arange(points) if point is None else point
        np.testing.assert_array_equal(point[vertex], held)  # a vertex is where the point is
        every = np.arange(len(held))
        keys = [tuple(np.concatenate([p.at_corners(every)[i] for p in primvars]).tolist()) for i in every]
        for i in every:  # and has what its corner has
            self.assertEqual(keys[corner[vertex[i]]], keys[i])
        pairs = {(int(held[i]), keys[i]) for i in every}
        self.assertEqual(len(pairs), len(np.unique(vertex)))
        return vertex

    def test_equal_corners_keep_their_points(self) -> None:
        corners = [0, 1, 2, 0, 2, 3]
        values = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32)[corners]
        vertex = self.check(corners, 4, weld.Primvar(values, None, True))
        np.testing.assert_array_equal(vertex, corners)

    def test_a_seam_splits_the_points_on_it(self) -> None:
        # Two triangles that share the edge 0 2, where the second one has other values.
        values = np.array([[0], [1], [2], [5], [6], [3]], np.float32)
        vertex = self.check([0, 1, 2, 0, 2, 3], 4, weld.Primvar(values, None, True))
        self.assertEqual(len(np.unique(vertex)), 6)

    def test_points_without_faces_are_dropped(self) -> None:
        vertex = self.check([4, 1, 2], 6, weld.Primvar(np.zeros((3, 2), np.float32), None, True))
        self.assertEqual(sorted(vertex.tolist()), [0, 1, 2])

    def test_other_numbers_of_equal_values_split_nothing(self) -> None:
        rows = np.array([[7], [8], [7]], np.float32)
        index = np.array([0, 1, 1, 2, 1, 1])
        vertex = self.check([0, 1, 2, 0, 1, 2], 3, weld.Primvar(rows, index, True))
        self.assertEqual(len(np.unique(vertex)), 3)

    def test_more_values_at_a_point_than_rounds(self) -> None:
        count = 3 * weld.ROUNDS
        values = (np.arange(2 * count) % count).astype(np.float32)[:, None]
        self.check([0] * (2 * count), 1, weld.Primvar(values, None, True))

    def test_by_chance(self) -> None:
        random = np.random.default_rng(5)
        corners = random.integers(0, 40, 600).tolist()
        of_pairs = weld.Primvar(random.integers(0, 3, (600, 2)).astype(np.float32), None, True)
        indexed = weld.Primvar(random.integers(0, 2, (9, 3)).astype(np.float32), random.integers(0, 9, 600), True)
        self.check(corners, 50, of_pairs, indexed)

    def test_seams_beyond_the_first_block(self) -> None:
        count = weld.BLOCK + 3000
        values = np.zeros((count, 3), np.float32)
        values[weld.BLOCK + 7, 1] = 1
        corners = np.arange(count, dtype=np.int32) % 1000
        vertex, _, corner = weld.weld(corners, 1000, [weld.Primvar(values, None, True)])
        self.assertEqual(len(corner), 1001)
        np.testing.assert_array_equal(np.flatnonzero(vertex == 1000), [weld.BLOCK + 7])
        self.assertEqual(corner[1000], weld.BLOCK + 7)


class Files(StageTest):
    def test_a_mesh_of_many_blocks_is_what_a_small_one_is(self) -> None:
        n = 450  # so many quads a side: vertices and faces of several blocks, and a file above what is compared
        row = [(i, j) for j in range(n + 1) for i in range(n + 1)]
        points = ", ".join(f"({i}, 0, {j})" for i, j in row)
        faces = ", ".join(
            str(v)
            for j in range(n)
            for i in range(n)
            for v in (j * (n + 1) + i, (j + 1) * (n + 1) + i, (j + 1) * (n + 1) + i + 1, j * (n + 1) + i + 1)
        )
        body = f"""def Mesh "floor" {{
            int[] faceVertexCounts = [{", ".join(["4"] * (n * n))}]
            int[] faceVertexIndices = [{faces}]
            point3f[] points = [{points}]
            normal3f[] normals = [{", ".join(["(0, 1, 0)"] * len(row))}]
            texCoord2f[] primvars:st = [{points.replace(", 0, ", ", ")}] ( interpolation = "vertex" )
            uniform token subdivisionScheme = "none"
        }}"""
        scene = self.convert(body, HEADER, strict=False)
        (name,) = scene.files
        self.assertEqual(len(list(scene._files.made[name].pieces())), 1 + 4 + 4)  # header, vertices, faces
        self.assert_bounds([0, 0, 0], [n, 0, n])
        content = scene.files[name]
        start = content.index(b"end_header\n") + len(b"end_header\n")
        rows = np.frombuffer(content, "<f4", len(row) * 8, start).reshape(-1, 8)
        np.testing.assert_array_equal(rows[:, [0, 2]], row)
        np.testing.assert_array_equal(rows[:, [6, 7]], row)
        self.assertEqual((self.folder / "stage-files" / name).read_bytes(), content)
        last = np.frombuffer(content[-17:], np.dtype([("length", "u1"), ("corners", "<i4", (4,))]))[0]
        self.assertEqual((int(last["length"]), last["corners"].tolist()), (4, [len(row) - n - 3, len(row) - 2, len(row) - 1, len(row) - n - 2]))


if __name__ == "__main__":
    unittest.main()
