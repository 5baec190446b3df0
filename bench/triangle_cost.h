// What queries and solves cost against the number of triangles: two meshes of the same shape, ever
// finer.
#ifndef MJCF_PDG_BENCH_TRIANGLE_COST_H_
#define MJCF_PDG_BENCH_TRIANGLE_COST_H_

namespace mjcf_pdg::bench {

// From 1K triangles to `largest` in each mesh, four times as many from row to row; then the
// exponents of the number of triangles that fit the rows best. Solves of `frames` overlaps.
void PrintTriangleCost(double tolerance, int largest, int frames);

}  // namespace mjcf_pdg::bench

#endif  // MJCF_PDG_BENCH_TRIANGLE_COST_H_
