#include "datasets/simulate/corridor/change.h"

namespace cairn::datasets::corridor {
namespace {

Rgb AnyPaint(Rng& rng) { return {rng.Uniform(0.1, 0.7), rng.Uniform(0.1, 0.7), rng.Uniform(0.1, 0.7)}; }

void ChangePanels(double share, Wall* wall, Rng& rng) {
  std::vector<Panel> kept;
  for (Panel panel : wall->panels) {
    const bool changes = panel.kind != PanelKind::kWindow && rng.Uniform() < share;
    if (changes && rng.Uniform() < 0.5) continue;
    if (changes) {
      panel.texture = rng.Bits32();
      panel.colour = AnyPaint(rng);
      panel.ink = AnyPaint(rng);
    }
    kept.push_back(panel);
  }
  wall->panels = kept;
}

}  // namespace

void ChangeWorld(double share, World* world, Rng& rng) {
  for (Wall& wall : world->walls) {
    ChangePanels(share, &wall, rng);
    for (Opening& opening : wall.openings) {
      if (opening.kind == OpeningKind::kDoor && rng.Uniform() < share) opening.colour = AnyPaint(rng);
    }
  }
  for (Bin& bin : world->bins) {
    if (rng.Uniform() < share) bin.x_m = rng.Uniform(0, world->length_m);
  }
}

}  // namespace cairn::datasets::corridor
