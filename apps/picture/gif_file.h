// Pictures one after the other, written as a GIF, which every browser, chat and slide shows.
#ifndef MJCF_PDG_APPS_PICTURE_GIF_FILE_H_
#define MJCF_PDG_APPS_PICTURE_GIF_FILE_H_

#include <string>
#include <vector>

#include "apps/picture/image.h"

namespace mjcf_pdg::app {

struct GifFrame {
  Image image;
  double seconds;  // for so long it is shown; GIF has hundredths
};

// Writes the frames, which must have one size, to be shown again and again. All share one palette,
// so that what stands still stays the same and takes no room. If that fails, throws
// std::runtime_error with a one-line reason and leaves no file.
void WriteGif(const std::vector<GifFrame>& frames, const std::string& path);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_PICTURE_GIF_FILE_H_
