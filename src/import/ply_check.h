// assimp 5.2 crashes on PLY files that end too early, or never comes back.
#ifndef MJCF_PDG_SRC_IMPORT_PLY_CHECK_H_
#define MJCF_PDG_SRC_IMPORT_PLY_CHECK_H_

#include <istream>

namespace mjcf_pdg {

// Whether a PLY file (ascii or binary, opened as binary) has a header that ends and all the values
// that it promises. What the values are is not looked at.
bool IsWholePly(std::istream& stream);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_IMPORT_PLY_CHECK_H_
