// Changes to good values that a peer that errs, or means harm, might make.
#pragma once

#include <google/protobuf/message.h>

#include "schema/blob.h"
#include "tests/fuzz/byte_source.h"

namespace cairn::fuzz {

// Sets one field of a message, or of a message within it, to a value of interest, or removes or doubles it.
void Scramble(google::protobuf::Message* message, ByteSource* source);

// Up to four changes: fields taken away, cut, of another type or shape, elements set to values of interest.
Blob Scrambled(const Blob& blob, ByteSource* source);

}  // namespace cairn::fuzz
