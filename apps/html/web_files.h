// The page and its script, which the build takes from apps/html/web.
#ifndef MJCF_PDG_APPS_HTML_WEB_FILES_H_
#define MJCF_PDG_APPS_HTML_WEB_FILES_H_

namespace mjcf_pdg::app {

extern const char kPageHtml[];
extern const char kBundleJs[];

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_HTML_WEB_FILES_H_
