// A check of PLY files before assimp reads them: assimp 5.2 crashes or hangs on files that end too
// early.
#ifndef MJCF_PDG_SRC_IMPORT_PLY_CHECK_H_
#define MJCF_PDG_SRC_IMPORT_PLY_CHECK_H_

#include <istream>

namespace mjcf_pdg {

// True if a PLY file (ASCII or binary; the stream must be opened as binary) has a complete header
// and as many values as the header promises. The values themselves are not checked.
bool IsWholePly(std::istream& stream);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_IMPORT_PLY_CHECK_H_
