// Pairs of pictures side by side on one sheet, written as a PNG file.
#ifndef MJCF_PDG_APPS_CONTACT_SHEET_H_
#define MJCF_PDG_APPS_CONTACT_SHEET_H_

#include <cstdint>
#include <string>
#include <vector>

namespace mjcf_pdg::app {

using Bytes = std::vector<std::uint8_t>;  // Red, green and blue of one pixel after the other.

class ContactSheet {
 public:
  // As many pairs a line as give the sheet about the shape of a picture.
  ContactSheet(int num_pairs, int picture_width, int picture_height);

  // `side`: 0 is left, 1 is right. `picture` has its lowest line first, as in OpenGL.
  void Paste(int pair, int side, const Bytes& picture);

  // Throws std::runtime_error with a one-line reason, and then leaves no file.
  void Write(const std::string& png_path) const;

 private:
  int picture_width_;
  int picture_height_;
  int columns_;  // Of pairs.
  int width_;
  int height_;
  Bytes rgb_;  // Highest line first.
};

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_CONTACT_SHEET_H_
