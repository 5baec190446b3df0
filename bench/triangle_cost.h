// The cost of queries and solves against the number of triangles, with two meshes of the same shape
// that get finer and finer.
#ifndef MJCF_PDG_BENCH_TRIANGLE_COST_H_
#define MJCF_PDG_BENCH_TRIANGLE_COST_H_

namespace mjcf_pdg::bench {

// Prints a row for each number of triangles, from 1K to `largest` in each mesh, four times as many
// from row to row, and then for each column the power of the number of triangles that fits the rows
// best. Solves are of `frames` poses that overlap. `tolerance` is in m.
void PrintTriangleCost(double tolerance, int largest, int frames);

}  // namespace mjcf_pdg::bench

#endif  // MJCF_PDG_BENCH_TRIANGLE_COST_H_
