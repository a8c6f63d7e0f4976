// A square window of cells that moves with the robot and never copies its contents: [DM98] section 2.2.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "pipelines/local_map/grids/plane.h"
#include "schema/error.h"

namespace cairn::local_map {

// The window holds the cells (i, j) of a plane without end with |i - centre.i|, |j - centre.j| <= half. Each
// lies in the array at (i mod N, j mod N), N = 2 half + 1, together with i and j: where they are others, that
// cell was scrolled out and the asked one is empty. So a move writes nothing but the centre, whatever N is.
template <class Cell>
class TorusGrid {
 public:
  TorusGrid(double cell_m, int half)
      : cell_m_(cell_m),
        half_(half),
        edge_(2 * half + 1),
        slots_(static_cast<std::size_t>(edge_) * static_cast<std::size_t>(edge_)) {
    CAIRN_DEMAND(cell_m > 0 && half >= 0, "a grid has cells");
    Clear();
    MoveTo(0, 0);
  }

  double cell_m() const { return cell_m_; }
  int half() const { return half_; }
  CellIndex centre() const { return centre_; }
  // Always in the central cell.
  Point robot() const { return robot_; }

  // The robot is at (x_m, y_m), whose cell becomes the central one. Costs the same however large the grid.
  // [DM98] section 2.2: the grid is coded as a torus.
  void MoveTo(double x_m, double y_m) {
    centre_ = {CellOf(x_m, cell_m_), CellOf(y_m, cell_m_)};
    robot_ = {x_m, y_m};
    first_i_ = Modulo(centre_.i - half_);
    first_j_ = Modulo(centre_.j - half_);
  }

  bool Holds(std::int32_t i, std::int32_t j) const {
    return Steps(i, centre_.i) < Edge() && Steps(j, centre_.j) < Edge();
  }

  // Null: nothing is known of that cell, or it is not in the window.
  const Cell* Find(std::int32_t i, std::int32_t j) const {
    if (!Holds(i, j)) return nullptr;
    const Slot& slot = slots_[SlotOf(i, j)];
    return slot.i == i && slot.j == j ? &slot.cell : nullptr;
  }

  // The cell, made if nothing is known of it. Null: it is not in the window.
  Cell* Touch(std::int32_t i, std::int32_t j) {
    if (!Holds(i, j)) return nullptr;
    Slot& slot = slots_[SlotOf(i, j)];
    if (slot.i != i || slot.j != j) slot = {i, j, Cell{}};
    return &slot.cell;
  }

  // visit(i, j, cell) of what is known in the window, rows from the lowest j.
  template <class Visit>
  void ForEach(Visit&& visit) const {
    for (std::int32_t j = centre_.j - half_; j <= centre_.j + half_; ++j)
      for (std::int32_t i = centre_.i - half_; i <= centre_.i + half_; ++i)
        if (const Cell* cell = Find(i, j)) visit(i, j, *cell);
  }

  void Clear() {
    for (Slot& slot : slots_) slot = {kNowhere, kNowhere, Cell{}};
  }

 private:
  struct Slot {
    std::int32_t i, j;
    Cell cell;
  };
  static constexpr std::int32_t kNowhere = std::numeric_limits<std::int32_t>::min();

  std::uint32_t Edge() const { return static_cast<std::uint32_t>(edge_); }
  // From the window's first cell; beyond its edge for cells outside.
  std::uint32_t Steps(std::int32_t i, std::int32_t centre) const {
    return static_cast<std::uint32_t>(i) - static_cast<std::uint32_t>(centre - half_);
  }
  std::uint32_t Modulo(std::int32_t i) const {
    const std::int32_t rest = i % edge_;
    return static_cast<std::uint32_t>(rest < 0 ? rest + edge_ : rest);
  }
  std::size_t SlotOf(std::int32_t i, std::int32_t j) const {
    std::uint32_t column = first_i_ + Steps(i, centre_.i), row = first_j_ + Steps(j, centre_.j);
    if (column >= Edge()) column -= Edge();
    if (row >= Edge()) row -= Edge();
    return static_cast<std::size_t>(row) * Edge() + column;
  }

  double cell_m_;
  std::int32_t half_, edge_;
  CellIndex centre_;
  Point robot_;
  std::uint32_t first_i_ = 0, first_j_ = 0;  // where the window's first cell lies in the array
  std::vector<Slot> slots_;
};

}  // namespace cairn::local_map
