#include "apps/picture/row_picture.h"

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace mjcf_pdg::app {
namespace {

std::string Millimetres(double metres) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g mm", 1000 * metres);
  return text;
}

std::vector<std::array<double, 3>> Places(const std::vector<Contact>& contacts) {
  std::vector<std::array<double, 3>> places;
  for (const Contact& contact : contacts) places.push_back(contact.position_W);
  return places;
}

// What overlaps, or how far joints are outside their limits, at a configuration.
std::string Flaw(double distance, double limit_excess) {
  if (distance < 0) return Millimetres(-distance) + " deep";
  if (limit_excess > 0) return "outside joint limits";
  return "too near";
}

}  // namespace

RenderRow PictureRow(const Configuration& configuration, const Result& result) {
  RenderRow row;
  row.title = configuration.label;
  const auto pose = [&configuration](const std::vector<double>& q) {
    return Pose{q, configuration.mocap_pos, configuration.mocap_quat};
  };
  for (const Contact& contact : result.contacts_in) {
    row.guilty_geoms.insert(row.guilty_geoms.end(), contact.geom.begin(), contact.geom.end());
  }
  row.before = {pose(configuration.q), false, "", Places(result.contacts_in)};
  row.after = {pose(result.q), result.status != Status::kUnsolved, "", {}};
  if (result.status == Status::kAlreadyFree) {
    row.before.text = row.after.text = "free as it is";
    return row;
  }
  row.before.text = "before: " + Flaw(result.depth_in, result.limit_excess_in);
  const std::string moved = "moved " + Millimetres(std::sqrt(result.sigma)) + " (rms)";
  if (row.after.free) {
    row.after.text = "after: free, " + moved;
  } else {
    row.after.text = "unsolved: " + Flaw(result.min_distance, 0) + ", " + moved;
    row.after.contacts = Places(result.contacts);
  }
  return row;
}

}  // namespace mjcf_pdg::app
