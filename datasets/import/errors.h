// `cairn import errors`: what it costs to take one position for another, as a matrix in a CSV file, plain or
// gzipped. Each row is a true position, each column after the first two a believed one, in the order of the
// rows:
//
//   x_m,y_m,lobby,lift,office      the columns' names are the user's; x_m and y_m may stand anywhere
//   0,0,0,2.5,9
//   3,1,2.5,0,7
//   8,1,9,7,0
#pragma once

#include <string>

#include "datasets/import/log_rows.h"
#include "schema/blob.h"

namespace cairn::datasets {

struct ErrorsImportOptions {
  std::string file;
};

// Makes `errors` (schema/FORMAT.md). The report warns where it costs something to take a position for itself.
// Throws InputError "FILE:LINE: REASON: DETAIL": not a number, not finite, below 0, wrong number of columns,
// more or fewer rows than there are columns for positions, a position that is there twice, no position, more
// than 4,096.
ImportReport ImportErrors(const ErrorsImportOptions& options, Blob* errors);

}  // namespace cairn::datasets
