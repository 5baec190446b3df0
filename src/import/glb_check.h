// A check of GLB files before assimp reads them: assimp 5.2 silently leaves out triangles whose
// corners do not exist.
#ifndef MJCF_PDG_SRC_IMPORT_GLB_CHECK_H_
#define MJCF_PDG_SRC_IMPORT_GLB_CHECK_H_

#include <string>

namespace mjcf_pdg {

// True if some triangle has a corner index beyond the number of vertices. `bytes` is the whole
// file. Only indices in the file's own buffer are checked, not compressed or sparse ones or those
// in another file; nor is anything else that may be wrong with the file.
bool GlbHasMissingCorners(const std::string& bytes);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_IMPORT_GLB_CHECK_H_
