// How a scene's tables (model/scene_tables.h) are made of a model and options.
#ifndef MJCF_PDG_SRC_SOLVE_MAKE_TABLES_H_
#define MJCF_PDG_SRC_SOLVE_MAKE_TABLES_H_

#include <memory>

#include "mjcf_pdg/scene.h"
#include "model/scene_tables.h"

namespace mjcf_pdg {

// `owner` owns *model, or is empty and *model must outlive the tables. Throws Error as the makers
// of Scene do.
std::shared_ptr<const SceneTables> MakeTables(std::shared_ptr<const mjModel> owner,
                                              const mjModel* model, const SceneOptions& options);

// The same of a copy of its model in which geoms are smaller; nothing else may differ.
std::shared_ptr<const SceneTables> ResizedTables(const SceneTables& tables,
                                                 std::shared_ptr<const mjModel> model);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_SOLVE_MAKE_TABLES_H_
