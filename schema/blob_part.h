// Parts of blobs (proto::BlobPart): what a task or a pipeline reads of a large one. Whoever has the whole
// cuts it, in memory or in a file, at the cost of what is cut. No files and sockets in here.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "schema/blob.h"
#include "schema/wire.pb.h"

namespace cairn {

// Rows [first, first + count) of one field.
proto::BlobPart RowsPart(const std::string& field, std::int64_t first, std::int64_t count);
// All fields, but of those whose names end in `but` their forms alone (Array::FormAlone).
proto::BlobPart HeadPart(const std::string& but);

// For people, whatever blob it is of; empty: nothing.
std::string WhatIsWrong(const proto::BlobPart& part);

// By which a part is known among blobs: other than the hash of what is in it, it is known before that.
Hash NameOfPart(const Hash& blob, const proto::BlobPart& part);

// An array of a part: where its bytes lie in those of the blob's array `index`.
struct CutArray {
  int index = 0;
  Shape shape;
  std::uint64_t from = 0, bytes = 0;
  bool form_alone = false;
};
// What a part takes of a blob.
// kRefused: there is no such part, or not of this blob; the message says of what and what it has.
Result<std::vector<CutArray>> CutsOf(const wire::BlobMeta& meta, const proto::BlobPart& part);

// Shares the blob's memory where rows begin as arrays do. kRefused as above.
Result<BlobPtr> CutPart(const Blob& blob, const proto::BlobPart& part);

// Whether what came as this part has its fields and rows.
bool MayBe(const Blob& came, const proto::BlobPart& part);

}  // namespace cairn
