// A sheet of pairs of pictures, each pair side by side, written as a PNG file.
#ifndef MJCF_PDG_APPS_PICTURE_CONTACT_SHEET_H_
#define MJCF_PDG_APPS_PICTURE_CONTACT_SHEET_H_

#include <cstdint>
#include <string>
#include <vector>

#include "apps/picture/image.h"

namespace mjcf_pdg::app {

class ContactSheet {
 public:
  // A sheet for `num_pairs` pairs of pictures of this size [pixels], with as many pairs a line as
  // give the sheet about the shape of a picture.
  ContactSheet(int num_pairs, int picture_width, int picture_height);

  // Puts a picture on the left (`side` 0) or right (1) of a pair.
  void Paste(int pair, int side, const Image& picture);

  // Writes the file. If that fails, throws std::runtime_error with a one-line reason and leaves no
  // file.
  void Write(const std::string& png_path) const;

 private:
  int picture_width_;
  int picture_height_;
  int columns_;  // Pairs in a line.
  int width_;    // Of the sheet [pixels].
  int height_;
  std::vector<std::uint8_t> rgb_;  // Of the sheet, highest line first.
};

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_PICTURE_CONTACT_SHEET_H_
