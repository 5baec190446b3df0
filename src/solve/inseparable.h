// Pairs that seem to overlap wherever the joints go. Not in the paper.
//
// Models often have such pairs: geoms of links that are drawn into each other, and that MuJoCo's
// filter of parent and child does not leave out because the links are two joints apart or children
// of a static body. No search can part them; the model must <exclude> them.
#ifndef MJCF_PDG_SRC_SOLVE_INSEPARABLE_H_
#define MJCF_PDG_SRC_SOLVE_INSEPARABLE_H_

#include <string>

#include "problem/workspace.h"

namespace mjcf_pdg {

// Finds the pairs that overlap at q and in each of 100 random configurations
// (StartSelection::Uniform). Returns the <exclude> lines of their bodies in words that end a
// sentence; empty if there is no such pair, if a joint is frozen, or if the budget is spent. This
// is evidence, not proof. Takes as many queries as it needs to see each pair parted once, 101 at
// most.
std::string DescribeInseparable(Workspace& work, const VectorXd& q);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_SOLVE_INSEPARABLE_H_
