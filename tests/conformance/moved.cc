#include "tests/conformance/moved.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <numeric>
#include <span>
#include <utility>

namespace cairn::conformance {
namespace {

constexpr double kMovedPi = std::numbers::pi;

double Wrapped(double angle_rad) {
  const double wrapped = std::remainder(angle_rad, 2 * kMovedPi);
  return wrapped <= -kMovedPi ? kMovedPi : wrapped;
}

std::string Last(const std::string& name) { return name.substr(name.rfind('/') + 1); }

// Said from the robot, or in a frame of the method's own.
bool IsElsewhere(const std::string& name) {
  return Last(name).starts_with("beam_") || name.starts_with("snapshots/") || name.starts_with("history/");
}

bool IsHeading(const std::string& name) {
  return !IsElsewhere(name) && (name.ends_with("heading_rad") || name.ends_with("direction_rad"));
}

class Mover {
 public:
  Mover(const Blob& blob, const Motion& motion) : blob_(blob), motion_(motion) {
    // Quarter turns without rounding.
    constexpr double kCos[] = {1, 0, -1, 0}, kSin[] = {0, 1, 0, -1};
    const int q = ((motion.quarters % 4) + 4) % 4;
    const double c = std::cos(motion.angle_rad), s = std::sin(motion.angle_rad);
    turn_ << kCos[q] * c - kSin[q] * s, -(kSin[q] * c + kCos[q] * s), kSin[q] * c + kCos[q] * s,
        kCos[q] * c - kSin[q] * s;
    quarters_ = q;
  }

  Blob Run() {
    for (const auto& [name, array] : blob_.fields()) {
      if (IsOfGrid(name) && array.shape().size() >= 2) {
        MoveGrid(name, array);
      } else if (Last(name) == "origin_x_m" || Last(name) == "origin_y_m") {
        continue;
      } else if (Last(name) == "cause" && array.type() == DType::kI32 && HasGrid()) {
        MoveCells(name);
      } else if (name.ends_with("x_m") && IsPosition(name)) {
        MovePoints(name.substr(0, name.size() - 3));
      } else if (name.ends_with("y_m") && IsPosition(name.substr(0, name.size() - 3) + "x_m")) {
        continue;
      } else if (IsHeading(name)) {
        Turn(name);
      } else if (Last(name) == "covariance" || Last(name).ends_with("covariance_m2")) {
        TurnCovariances(name, array);
      } else {
        moved_.Put(name, array);
      }
    }
    if (HasGrid()) MoveOrigin();
    return std::move(moved_);
  }

 private:
  static bool IsOfGrid(const std::string& name) { return name.starts_with("map/grid/"); }
  bool HasGrid() const { return blob_.Has("map/grid/origin_x_m"); }
  double angle() const { return motion_.angle_rad + quarters_ * kMovedPi / 2; }

  bool IsPosition(const std::string& x_name) const {
    const std::string base = x_name.substr(0, x_name.size() - 3);
    return !IsElsewhere(x_name) && blob_.Has(base + "x_m") && blob_.Has(base + "y_m") &&
           blob_.at(base + "x_m").type() == DType::kF64;
  }

  void MovePoints(const std::string& base) {
    const auto x = blob_.Get<double>(base + "x_m"), y = blob_.Get<double>(base + "y_m");
    std::vector<double> moved_x, moved_y;
    for (std::size_t k = 0; k < x.size(); ++k) {
      moved_x.push_back(turn_(0, 0) * x[k] + turn_(0, 1) * y[k] + motion_.x_m);
      moved_y.push_back(turn_(1, 0) * x[k] + turn_(1, 1) * y[k] + motion_.y_m);
    }
    moved_.Put(base + "x_m", Array::Of<double>(blob_.at(base + "x_m").shape(), moved_x));
    moved_.Put(base + "y_m", Array::Of<double>(blob_.at(base + "y_m").shape(), moved_y));
  }

  void Turn(const std::string& name) {
    std::vector<double> turned;
    for (const double heading : blob_.Get<double>(name)) turned.push_back(Wrapped(heading + angle()));
    moved_.Put(name, Array::Of<double>(blob_.at(name).shape(), turned));
  }

  void TurnCovariances(const std::string& name, const Array& array) {
    const bool joint = array.shape().size() == 4;  // of all points together
    const auto n = static_cast<Eigen::Index>(array.shape().back() * (joint ? array.shape()[0] : 1));
    const auto values = blob_.Get<double>(name);
    Eigen::MatrixXd turn = Eigen::MatrixXd::Identity(n, n);
    for (Eigen::Index k = 0; k < (joint ? n : 2); k += 2) turn.block<2, 2>(k, k) = turn_;
    std::vector<double> turned;
    for (std::size_t at = 0; at + static_cast<std::size_t>(n * n) <= values.size();
         at += static_cast<std::size_t>(n * n)) {
      Eigen::MatrixXd c(n, n);
      for (Eigen::Index i = 0; i < n * n; ++i) c(i / n, i % n) = values[at + static_cast<std::size_t>(i)];
      const Eigen::MatrixXd t = turn * c * turn.transpose();
      for (Eigen::Index i = 0; i < n * n; ++i) turned.push_back(t(i / n, i % n));
    }
    moved_.Put(name, Array::Of<double>(array.shape(), turned));
  }

  // Where cell (row, column) of a grid of that shape comes to lie.
  struct Cell {
    std::int64_t row, column, rows, columns;
  };
  Cell Turned(Cell cell) const {
    for (int q = 0; q < quarters_; ++q)
      cell = {cell.column, cell.rows - 1 - cell.row, cell.columns, cell.rows};
    return cell;
  }

  void MoveGrid(const std::string& name, const Array& array) {
    switch (array.type()) {
      case DType::kF64:
        return MoveGridOf<double>(name, array);
      case DType::kF32:
        return MoveGridOf<float>(name, array);
      case DType::kU8:
        return MoveGridOf<std::uint8_t>(name, array);
      default:
        throw InputError("a grid of such numbers: " + name);
    }
  }
  template <class T>
  void MoveGridOf(const std::string& name, const Array& array) {
    std::vector<std::int64_t> shape = array.shape();
    const std::int64_t rows = shape[shape.size() - 2], columns = shape.back();
    const std::int64_t layers = rows * columns > 0 ? array.size() / (rows * columns) : 0;
    const auto values = blob_.Get<T>(name);
    std::vector<T> turned(values.size());
    for (std::int64_t k = 0; k < layers * rows * columns; ++k) {
      const std::int64_t in_layer = k % (rows * columns);
      const Cell to = Turned({in_layer / columns, in_layer % columns, rows, columns});
      turned[static_cast<std::size_t>(k - in_layer + to.row * to.columns + to.column)] =
          values[static_cast<std::size_t>(k)];
    }
    if (quarters_ % 2 == 1) std::swap(shape[shape.size() - 2], shape.back());
    moved_.Put(name, Array::Of<T>(shape, turned));
  }

  void MoveCells(const std::string& name) {
    const auto& shape = blob_.at("map/grid/probability").shape();
    std::vector<std::int32_t> cells;
    for (const std::int32_t cell : blob_.Get<std::int32_t>(name)) {
      const Cell to = Turned({cell / shape[1], cell % shape[1], shape[0], shape[1]});
      cells.push_back(cell < 0 ? cell : static_cast<std::int32_t>(to.row * to.columns + to.column));
    }
    moved_.Put(name, Array::Of<std::int32_t>(blob_.at(name).shape(), cells));
  }

  // Of the corners of the turned grid the lowest.
  void MoveOrigin() {
    const auto& shape = blob_.at("map/grid/probability").shape();
    const double cell_m = blob_.Scalar<double>("map/grid/cell_m");
    const Eigen::Vector2d low(blob_.Scalar<double>("map/grid/origin_x_m"),
                              blob_.Scalar<double>("map/grid/origin_y_m"));
    const Eigen::Vector2d size(cell_m * static_cast<double>(shape.back()),
                               cell_m * static_cast<double>(shape[shape.size() - 2]));
    const Eigen::Vector2d a = turn_ * low, b = turn_ * (low + size);
    moved_.PutScalar("map/grid/origin_x_m", std::min(a.x(), b.x()) + motion_.x_m);
    moved_.PutScalar("map/grid/origin_y_m", std::min(a.y(), b.y()) + motion_.y_m);
  }

  const Blob& blob_;
  const Motion motion_;
  int quarters_ = 0;
  Eigen::Matrix2d turn_;
  Blob moved_;
};

template <class T>
double Farthest(const Array& a, const Array& b, bool angles) {
  const auto left = a.As<T>(), right = b.As<T>();
  double farthest = 0;
  for (std::size_t k = 0; k < left.size(); ++k) {
    const auto l = static_cast<double>(left[k]), r = static_cast<double>(right[k]);
    if (std::isnan(l) && std::isnan(r)) continue;
    const double apart = l == r ? 0 : std::abs(angles ? std::remainder(l - r, 2 * kMovedPi) : l - r);
    if (!(apart <= farthest)) farthest = apart;  // also where one of them is NaN
  }
  return farthest;
}

double Apart(const std::string& name, const Array& a, const Array& b) {
  switch (a.type()) {
    case DType::kF64:
      return Farthest<double>(a, b, name.ends_with("heading_rad") || name.ends_with("direction_rad"));
    case DType::kF32:
      return Farthest<float>(a, b, false);
    case DType::kU8:
      return Farthest<std::uint8_t>(a, b, false);
    case DType::kI32:
      return Farthest<std::int32_t>(a, b, false);
    case DType::kI64:
      return Farthest<std::int64_t>(a, b, false);
    default: {
      Blob left, right;
      left.Put("text", a);
      right.Put("text", b);
      return left.ContentHash() == right.ContentHash() ? 0 : 1;
    }
  }
}

}  // namespace

Blob Moved(const Blob& blob, const Motion& motion) { return Mover(blob, motion).Run(); }

Blob Reordered(const Blob& blob, const std::string& group, const std::vector<std::size_t>& order) {
  const std::string list = group + "s", prefix = group + "/";
  Blob reordered = blob.Without(prefix);
  const std::vector<std::string> names = blob.Texts(list);
  std::vector<std::string> reordered_names;
  for (std::size_t n = 0; n < order.size(); ++n) {
    reordered_names.push_back(names.at(order[n]));
    reordered.PutAll(prefix + std::to_string(n) + "/", blob.Sub(prefix + std::to_string(order[n]) + "/"));
  }
  reordered.Put(list, Array::Texts(reordered_names));
  return reordered;
}

namespace {

template <class T>
Array RowsInOrder(const Array& array, const std::vector<std::size_t>& order) {
  const auto values = array.As<T>();
  const std::size_t width = values.size() / order.size();
  std::vector<T> sorted;
  for (const std::size_t row : order)
    sorted.insert(sorted.end(), values.begin() + static_cast<std::ptrdiff_t>(row * width),
                  values.begin() + static_cast<std::ptrdiff_t>((row + 1) * width));
  return Array::Of<T>(array.shape(), sorted);
}

}  // namespace

Blob InOrder(const Blob& result) {
  if (!result.Has("map/along_m") || !result.Has("map/run")) return result;
  const auto run = result.Get<std::int32_t>("map/run");
  const auto along = result.Get<double>("map/along_m");
  std::vector<std::size_t> order(run.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t k) { return std::pair(run[k], along[k]); });
  Blob ordered = result;
  for (const auto& [name, array] : result.fields()) {
    if (!name.starts_with("map/") || array.shape().empty()) continue;
    if (array.shape()[0] != static_cast<std::int64_t>(order.size())) continue;
    if (array.type() == DType::kF64) ordered.Put(name, RowsInOrder<double>(array, order));
    if (array.type() == DType::kF32) ordered.Put(name, RowsInOrder<float>(array, order));
    if (array.type() == DType::kI32) ordered.Put(name, RowsInOrder<std::int32_t>(array, order));
  }
  return ordered;
}

Blob InItsOwnFrame(const Blob& result) {
  Blob own = result;
  for (std::size_t n = 0; n < result.Texts("robots").size(); ++n) {
    const std::string robot = "robot/" + std::to_string(n) + "/", poses = robot + "poses/";
    const auto x = result.Get<double>(poses + "x_m"), y = result.Get<double>(poses + "y_m");
    const auto heading = result.Get<double>(poses + "heading_rad");
    if (x.empty()) continue;
    Blob path;
    for (const char* name : {"x_m", "y_m", "heading_rad"}) path.Put(name, result.at(poses + name));
    path = Moved(path, {.x_m = -x[0], .y_m = -y[0]});
    path = Moved(path, {.angle_rad = -heading[0]});
    own.PutAll(poses, path);
    own = own.Without(robot + "walls/angle_rad");  // said in the frame of the run's dead reckoning
  }
  return own;
}

std::string Differences(const Blob& a, const Blob& b, double tolerance,
                        const std::function<bool(const std::string&)>& passed_over) {
  std::string differences;
  const auto looked_at = [&](const std::string& name) {
    return !name.ends_with("_hash") && !(passed_over && passed_over(name));
  };
  for (const auto& [name, array] : a.fields()) {
    if (!looked_at(name)) continue;
    if (!b.Has(name)) {
      differences += name + " is in one only\n";
    } else if (b.at(name).type() != array.type() || b.at(name).shape() != array.shape()) {
      differences += name + " has another type or shape\n";
    } else if (const double apart = Apart(name, array, b.at(name)); !(apart <= tolerance)) {
      char text[64];
      std::snprintf(text, sizeof text, " is %.3g off\n", apart);
      differences += name + text;
    }
  }
  for (const auto& [name, array] : b.fields()) {
    if (looked_at(name) && !a.Has(name)) differences += name + " is in one only\n";
  }
  return differences;
}

}  // namespace cairn::conformance
