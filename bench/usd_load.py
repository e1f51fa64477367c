"""How long a USD stage of ten million triangles takes, against usd-core itself: `usd_load.py FOLDER [STAGE…]`.

For each stage: what usd-core takes to open it, go through its prims and read their arrays into memory; what abbe.usd takes to
make a scene of it; and what it takes to load and to write that scene and its files. Seconds are those of processors, which other
programs disturb less. Each figure is the least of five, each in a process of its own, with the stage in the cache of the system.
Stages are made in FOLDER, once, and are about 2.2 GB together.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, Vt

HERE = Path(__file__).resolve().parent
RUNS = 5
TRIANGLES = 10_000_000


def grid(columns: int, rows: int, phase: float) -> tuple[Any, Any, Any, Any]:
    """Points, corners of quads, texture coordinates and normals of a wavy sheet; the last two by point."""
    u, v = np.meshgrid(np.linspace(0, 1, columns + 1, dtype=np.float32), np.linspace(0, 1, rows + 1, dtype=np.float32))
    wave = np.sin(u * 40 + np.float32(phase)) * np.cos(v * 40)
    points = np.stack([u, np.float32(0.02) * wave, v], axis=2).reshape(-1, 3).astype(np.float32)
    slope_u = np.float32(0.8) * np.cos(u * 40 + np.float32(phase)) * np.cos(v * 40)
    slope_v = np.float32(-0.8) * np.sin(u * 40 + np.float32(phase)) * np.sin(v * 40)
    normals = np.stack([-slope_u, np.ones_like(u), -slope_v], axis=2).reshape(-1, 3)
    normals = (normals / np.linalg.norm(normals, axis=1, keepdims=True)).astype(np.float32)
    first = (np.arange(rows, dtype=np.int32)[:, None] * (columns + 1) + np.arange(columns, dtype=np.int32)).reshape(-1)
    quads = np.stack([first, first + columns + 1, first + columns + 2, first + 1], axis=1)
    return points, quads, np.stack([u, v], axis=2).reshape(-1, 2).astype(np.float32), normals


def triangles(quads: Any) -> Any:
    return quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)


def sheet(stage: Usd.Stage, path: str, columns: int, rows: int, kind: str, phase: float = 0.0) -> None:
    """A sheet as a mesh. `seams` cuts the texture coordinates into charts of 64 × 64 quads."""
    points, quads, uvs, normals = grid(columns, rows, phase)
    mesh = UsdGeom.Mesh.Define(stage, path)
    faces = quads if kind == "cage" else triangles(quads)
    corners = faces.reshape(-1)
    mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(points))
    mesh.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(len(faces), faces.shape[1], np.int32)))
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(np.ascontiguousarray(corners, np.int32)))
    mesh.CreateSubdivisionSchemeAttr("catmullClark" if kind == "cage" else "none")
    api = UsdGeom.PrimvarsAPI(mesh)
    rule = "vertex" if kind in ("vertex", "cage") else "faceVarying"
    st = api.CreatePrimvar("st", Sdf.ValueTypeNames.TexCoord2fArray, rule)
    if kind == "cage":
        st.Set(Vt.Vec2fArray.FromNumpy(uvs))
        return
    normal = api.CreatePrimvar("normals", Sdf.ValueTypeNames.Normal3fArray, rule)
    if kind == "vertex":
        st.Set(Vt.Vec2fArray.FromNumpy(uvs))
        normal.Set(Vt.Vec3fArray.FromNumpy(normals))
    elif kind == "indexed":
        st.Set(Vt.Vec2fArray.FromNumpy(uvs))
        st.SetIndices(Vt.IntArray.FromNumpy(corners))
        normal.Set(Vt.Vec3fArray.FromNumpy(normals))
        normal.SetIndices(Vt.IntArray.FromNumpy(corners))
    else:
        by_corner = uvs[corners]
        if kind == "seams":
            chart = np.repeat(((np.arange(rows) // 64)[:, None] * 1000 + np.arange(columns) // 64).reshape(-1), 6)
            by_corner = by_corner + (chart * np.float32(1.25)).astype(np.float32)[:, None]
        st.Set(Vt.Vec2fArray.FromNumpy(np.ascontiguousarray(by_corner)))
        normal.Set(Vt.Vec3fArray.FromNumpy(normals[corners]))


def one_mesh(kind: str) -> Any:
    def make(stage: Usd.Stage) -> None:
        sheet(stage, "/World/sheet", 2500, TRIANGLES // 5000, kind)

    return make


def many_meshes(kind: str) -> Any:
    def make(stage: Usd.Stage) -> None:
        for i in range(TRIANGLES // 1000):
            sheet(stage, f"/World/row_{i // 100}/sheet_{i % 100}", 25, 20, kind, i * 0.01)
            UsdGeom.Xformable(stage.GetPrimAtPath(f"/World/row_{i // 100}/sheet_{i % 100}")).AddTranslateOp().Set(Gf.Vec3d(i % 100, 0, i // 100))

    return make


def cages(stage: Usd.Stage) -> None:
    sheet(stage, "/World/cage", 2500, TRIANGLES // 5000, "cage")


STAGES = {
    "corners": ("one mesh; texture coordinates and normals by corner", one_mesh("corners")),
    "seams": ("the same, cut into charts of 64 × 64 quads", one_mesh("seams")),
    "indexed": ("one mesh; both by corner with indices", one_mesh("indexed")),
    "vertex": ("one mesh; both by point", one_mesh("vertex")),
    "many": ("10 000 meshes of 1000 triangles, both by corner", many_meshes("corners")),
    "cage": ("5 million quads to subdivide, texture coordinates by point", cages),
}


def make(path: Path, name: str) -> None:
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageUpAxis(stage, "Y")
    UsdGeom.SetStageMetersPerUnit(stage, 1)
    stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, "/World").GetPrim())
    STAGES[name][1](stage)
    stage.Save()


def read_all(path: str) -> float:
    """Opens the stage, goes through it and reads what a mesh has: each array once, as numbers in memory."""
    start = time.process_time()
    stage = Usd.Stage.Open(path)
    total = 0
    for prim in stage.Traverse():
        if not prim.IsA(UsdGeom.Mesh):
            continue
        mesh = UsdGeom.Mesh(prim)
        mesh.GetSubdivisionSchemeAttr().Get()
        arrays = [mesh.GetPointsAttr().Get(), mesh.GetFaceVertexCountsAttr().Get(), mesh.GetFaceVertexIndicesAttr().Get()]
        for primvar in UsdGeom.PrimvarsAPI(prim).GetPrimvarsWithValues():
            arrays += [primvar.Get(), primvar.GetIndices()]
        UsdGeom.Xformable(prim).GetLocalTransformation()
        total += sum(np.array(a).nbytes for a in arrays if a is not None)
    return time.process_time() - start


def load(path: str, out: str) -> tuple[float, float]:
    sys.path.insert(0, str(HERE.parent / "python/src"))
    from abbe import usd

    start = time.process_time()
    scene = usd.load(path)
    loaded = time.process_time() - start
    shutil.rmtree(out, ignore_errors=True)
    scene.write(Path(out) / "x.scene")
    return loaded, time.process_time() - start


def peak() -> float:
    """The most memory of this program so far, in GiB. `ru_maxrss` would also count what had begun it."""
    line = next(line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmHWM"))
    return int(line.split()[1]) / 2**20


def measure(*commands: list[str]) -> list[list[float]]:
    """The least of each figure of some runs. Commands take turns, as machines are faster at one time than at another."""
    found: list[list[list[float]]] = [[] for _ in commands]
    for _ in range(RUNS):
        for figures, arguments in zip(found, commands, strict=True):
            done = subprocess.run([sys.executable, __file__, *arguments], capture_output=True, text=True, check=True)
            figures.append(json.loads(done.stdout.splitlines()[-1]))
    return [[min(column) for column in zip(*figures, strict=True)] for figures in found]


def main(arguments: list[str]) -> int:
    if arguments[:1] == ["--read"]:
        print(json.dumps([read_all(arguments[1]), peak()]))
        return 0
    if arguments[:1] == ["--load"]:
        times = load(arguments[1], arguments[2])
        print(json.dumps([*times, peak()]))
        return 0
    if not arguments:
        sys.stderr.write(f"{__doc__}\nstages: {', '.join(STAGES)}\n")
        return 2
    folder = Path(arguments[0])
    folder.mkdir(parents=True, exist_ok=True)
    print("| stage of 10 million triangles | usd-core | `usd.load` | times | loaded and written | GiB: usd-core, `usd.load` |")
    print("|---|--:|--:|--:|--:|--:|")
    for name in arguments[1:] or list(STAGES):
        path = folder / f"{name}.usdc"
        if not path.exists():
            make(path, name)
        path.read_bytes()
        (read, read_memory), (loaded, written, memory) = measure(["--read", str(path)], ["--load", str(path), str(folder / "out")])
        print(
            f"| {STAGES[name][0]} | {read:.2f} s | {loaded:.2f} s | {loaded / read:.2f} | {written:.2f} s | {read_memory:.1f}, {memory:.1f} |",
            flush=True,
        )
        shutil.rmtree(folder / "out", ignore_errors=True)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
