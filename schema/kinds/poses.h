// schema/FORMAT.md, `poses`: where robots were, by anybody.
#pragma once

#include "schema/geometry.h"
#include "schema/kinds/fields.h"

namespace cairn::kinds {

// A row a time.
struct PoseTable {
  Column<double> time_s, x_m, y_m, heading_rad;

  std::size_t size() const { return time_s.size(); }
  Pose operator[](std::size_t i) const { return {x_m[i], y_m[i], heading_rad[i]}; }
  std::vector<Pose> poses() const {
    std::vector<Pose> all;
    for (std::size_t i = 0; i < x_m.size(); ++i) all.push_back((*this)[i]);
    return all;
  }
  // Headings as they are.
  void Set(const std::vector<double>& times_s, const std::vector<Pose>& poses) {
    time_s = times_s;
    x_m = ColumnOf(poses, &Pose::x_m);
    y_m = ColumnOf(poses, &Pose::y_m);
    heading_rad = ColumnOf(poses, &Pose::heading_rad);
  }
  static void Fields(const auto& field) {
    field(Needed("time_s", "P", Rising()), &PoseTable::time_s);
    field(Needed("x_m", "P", Position()), &PoseTable::x_m);
    field(Needed("y_m", "P", Position()), &PoseTable::y_m);
    field(Needed("heading_rad", "P", Angle()), &PoseTable::heading_rad);
  }
};

// Under `prefix`, the most likely poses where the file has them, else the means.
inline PoseTable LikeliestPoses(const std::string& prefix, const Blob& blob) {
  auto poses = FieldsIn<PoseTable>(blob.Has(prefix + "mode_x_m") ? prefix + "mode_" : prefix, blob);
  poses.time_s = Column<double>::In(blob, prefix + "time_s");
  return poses;
}

struct UncertainPoses : PoseTable {
  Column<double> covariance;  // of x, y, heading

  static void Fields(const auto& field) {
    PoseTable::Fields(field);
    field({"covariance", "P,3,3", Finite()}, &UncertainPoses::covariance);
  }
};

struct Poses {
  struct Robot {
    UncertainPoses poses;
    static void Fields(const auto& field) { field("poses", &Robot::poses); }
  };
  Texts robots;
  std::vector<Robot> robot;

  static void Fields(const auto& field) {
    field({"robots", "R"}, &Poses::robots);
    field("robot", &Poses::robot);
  }
};

}  // namespace cairn::kinds
