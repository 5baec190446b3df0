// Pairs of pictures in lines, on one sheet.
#ifndef MJCF_PDG_APPS_CONTACT_SHEET_H_
#define MJCF_PDG_APPS_CONTACT_SHEET_H_

#include <cstdint>
#include <vector>

#include "apps/png_writer.h"

namespace mjcf_pdg::app {

class ContactSheet {
 public:
  // As many pairs a line as give the sheet about the shape of a picture.
  ContactSheet(int num_pairs, int picture_width, int picture_height);

  // `pixels`: 3 bytes each, the lowest line first. What is not pasted stays empty.
  enum Side { kLeft, kRight };
  void Paste(int pair, Side side, const std::vector<std::uint8_t>& pixels);

  const RgbImage& image() const { return image_; }

 private:
  int picture_width_;
  int picture_height_;
  int columns_;
  RgbImage image_;
};

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_CONTACT_SHEET_H_
