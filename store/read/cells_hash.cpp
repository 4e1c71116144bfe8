// What the index says of level 0, without the places: nothing of the cells is read.
#include "store/format/metadata_json.hpp"
#include "store/read/reader.hpp"

namespace teracell::inline store {

std::string GridReader::cells_hash() const {
  cells_hashed_([&] {
    ContentHash hash;
    Metadata meta = meta_;
    meta.channels = Metadata().channels;
    hash.add(encode_metadata(meta));
    Bytes bytes;
    put_varint(bytes, footer_.report.checksum);
    for (uint64_t page = 0; page < shape(0).pages(); ++page) {
      for (const ChunkEntry& entry : *this->page(0, page)) put_entry(bytes, entry, true);
      hash.add(bytes);
      bytes.clear();
    }
    cells_hash_ = hex(hash.digest());
  });
  return cells_hash_;
}

}  // namespace teracell::store
