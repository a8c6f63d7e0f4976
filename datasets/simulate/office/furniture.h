// What stands in an office, clear of the ways that a robot drives.
#pragma once

#include <vector>

#include "datasets/simulate/office/plan.h"

namespace cairn::datasets::office {

// Shelves along walls, a table in the middle, chairs that stand any way round; in the room's frame.
std::vector<Piece> DrawFurniture(const Room& room, Rng& rng);

// Cabinets along the corridor's walls, clear of doors.
std::vector<Piece> DrawCabinets(const Office& office, Rng& rng);

// Its four sides, in the world.
void AddSides(const Piece& piece, const Room& room, std::vector<Obstacle>* obstacles);

}  // namespace cairn::datasets::office
