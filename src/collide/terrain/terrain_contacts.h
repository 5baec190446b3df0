// The narrow phase for height fields: signed distances and contact features of a convex geom and
// the true surface of a field. ContactFinder (collide/contacts.h) asks it.
//
// Where the geom's core is apart from the field, the features are the nearest points to the prisms
// below it (model/height_field.h): of each block of the cells near the geom the nearest, and those
// that reach above the planes of nearer ones. Where the
// core overlaps, the geom is moved out first, by the shortest way that WayOut finds, and a little
// farther, so that contact normals exist. The features there, moved back, are those of the overlap:
// their distances are negative by what the way out goes along their normals. In contact both agree.
#ifndef MJCF_PDG_SRC_COLLIDE_TERRAIN_TERRAIN_CONTACTS_H_
#define MJCF_PDG_SRC_COLLIDE_TERRAIN_TERRAIN_CONTACTS_H_

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "base/signed_gap.h"
#include "collide/terrain/highest_blocks.h"
#include "collide/terrain/way_out.h"

namespace mjcf_pdg {

// One per thread: it keeps its scratch.
class TerrainContacts {
 public:
  // `tables` must outlive this object.
  explicit TerrainContacts(const SceneTables& tables);

  // Appends the features of SceneTables::pairs[pair], whose geom 1 is a height field, that are
  // nearer than `margin` [m], in the world frame W, the deepest or nearest first.
  void Features(const PosedModel& posed, int pair, double margin, std::vector<SignedGap>& out);
  // The signed distance if the two are apart; if they overlap, minus the length of the shortest way
  // out that is found, which is no more than the signed distance. Returns true and fills `gap` if
  // it is below `cutoff` [m]; otherwise leaves `gap` alone.
  bool Distance(const PosedModel& posed, int pair, double cutoff, SignedGap& gap);

  // Distances of a geom and a prism since construction.
  std::int64_t distances() const { return distances_; }

 private:
  bool IsAbove(const PosedModel& posed, const KeptPair& pair, double margin) const;
  enum class Blocks { kOne, kFour };  // kFour: two along each side
  bool AppendApart(const OnTerrain& on, const Vector3d& shift, double margin, Blocks blocks);
  using Block = std::vector<NearPrism*>;
  bool AppendBlock(const OnTerrain& on, const Vector3d& shift, double margin, double reach,
                   bool only_nearest, Block& block);
  bool Nearest(const OnTerrain& on, const Vector3d& shift, double reach, Block& block,
               int& nearest);
  void Raise(NearPrism& near) const;
  static SignedGap ToWorld(const OnTerrain& on, const SignedGap& gap);

  const SceneTables& tables_;
  std::map<int, HighestBlocks> blocks_;  // of the height fields, by geom
  WayOut way_out_;
  std::vector<NearPrism> near_;
  std::array<Block, 4> in_blocks_;   // those of near_ that may be nearest in their blocks
  std::vector<GjkNearest> answers_;  // of those that were measured
  // What parts the core from one prism parts it from most of its neighbours, too: the normals of
  // all answers in a block, and the least n · p of points p of the core.
  struct Plane {
    Vector3d n;
    double begin;
  };
  std::vector<Plane> planes_;
  std::vector<SignedGap> scratch_;
  std::int64_t distances_ = 0;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_TERRAIN_TERRAIN_CONTACTS_H_
