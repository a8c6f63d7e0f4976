// How fast blobs of 16 MB reach a worker over TCP on loopback, beside what the machine could do at best.
#pragma once

namespace cairn::bench {

// Prints the best of a few turns.
void PrintBlobRates();

}  // namespace cairn::bench
