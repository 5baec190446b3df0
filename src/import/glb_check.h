// assimp 5.2 leaves out triangles of GLB files whose corners do not exist, without a word.
#ifndef MJCF_PDG_SRC_IMPORT_GLB_CHECK_H_
#define MJCF_PDG_SRC_IMPORT_GLB_CHECK_H_

#include <string>

namespace mjcf_pdg {

// Whether a corner index in a GLB file's own buffer is that of no vertex. What else may be wrong
// with the file is not looked at, nor are indices elsewhere (compressed, sparse, another file).
bool GlbHasMissingCorners(const std::string& bytes);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_IMPORT_GLB_CHECK_H_
