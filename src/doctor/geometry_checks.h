// Rays against meshes: none meets the surface that it leaves, none gets through a closed one.
#pragma once

namespace abbe::doctor {

// Of `rays` that leave a convex mesh of 32 000 triangles at all angles, half of them grazing, the share that meets it
// again. The mesh lies `offset` m from the origin. Docs: hard_cases.md, cases 1 and 2. Requires rays > 0.
double selfIntersections(int rays, double offset);
// Of `rays` from inside a closed mesh, all of them aimed at its edges, the number that escapes (case 5).
double escapesAtEdges(int rays);
// The same for its vertices, as a share. Embree decides about each edge by itself, so that where many of them meet all
// faces around a vertex may be missed by a ray that passes it within a rounding. Requires rays > 0.
double escapesAtVertices(int rays);

} // namespace abbe::doctor
