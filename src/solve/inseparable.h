// Pairs that seem to overlap wherever the joints go.
//
// Nothing of the paper. Models often have such pairs: links drawn into each other that MuJoCo's
// filters keep, as those of a static body's children and of links two joints apart. No search can
// part them; the model must <exclude> them.
#ifndef MJCF_PDG_SRC_SOLVE_INSEPARABLE_H_
#define MJCF_PDG_SRC_SOLVE_INSEPARABLE_H_

#include <string>

#include "problem/workspace.h"

namespace mjcf_pdg {

// The <exclude> lines of the bodies whose pairs overlap at q and in each of 100 configurations
// anywhere (StartSelection::Uniform), in words that end a sentence; empty if there are none, or
// some joint is frozen. No proof. Stops when the budget is spent. As many queries as it takes to
// find each pair parted, at most 101.
std::string DescribeInseparable(Workspace& work, const VectorXd& q);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_SOLVE_INSEPARABLE_H_
