// What is drawn of a row that was solved.
#ifndef MJCF_PDG_APPS_PICTURE_ROW_PICTURE_H_
#define MJCF_PDG_APPS_PICTURE_ROW_PICTURE_H_

#include "apps/input/configurations.h"
#include "apps/picture/render.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg::app {

// The configuration as it was given and as it became, with their contacts, which `result` must
// have (Options::report_contacts); depth and displacement in words.
RenderRow PictureRow(const Configuration& configuration, const Result& result);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_PICTURE_ROW_PICTURE_H_
