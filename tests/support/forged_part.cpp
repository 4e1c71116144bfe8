#include "tests/support/forged_part.hpp"

#include "store/format/format.hpp"

namespace teracell::testing {
namespace {

void put_framed(Bytes& out, const std::string& text) {
  const Bytes frame = encode_text(text);
  put_varint(out, frame.size());
  out.insert(out.end(), frame.begin(), frame.end());
}

}  // namespace

PartSections take_apart(const Bytes& part) {
  ByteReader in(part, "part"), footer({part.data() + part.size() - 64, 64}, "footer");
  const auto records = footer.fixed<uint64_t>();
  footer.take(8);
  const auto found = footer.fixed<uint64_t>();
  in.take(8);
  const auto head_bytes = in.fixed<uint64_t>();
  in.take(8);
  ByteReader head(in.take(head_bytes), "head");
  const auto bytes = [&](uint64_t size) {
    const auto taken = in.take(size);
    return Bytes(taken.begin(), taken.end());
  };
  PartSections out;
  out.head = decode_text(head.take(head.varint()), "head");
  out.metadata = decode_text(head.take(head.varint()), "metadata");
  out.grid = bytes(in.remaining() - 64 - found - records);
  out.records = bytes(records);
  out.found = bytes(found);
  return out;
}

Bytes put_together(const PartSections& sections) {
  const std::string magic = "tcellptB";
  Bytes head, footer, out(magic.begin(), magic.end());
  put_framed(head, sections.head);
  put_framed(head, sections.metadata);
  put_fixed(out, uint64_t{head.size()});
  put_fixed(out, checksum(head));
  for (const Bytes* bytes : std::initializer_list<const Bytes*>{&head, &sections.grid, &sections.records, &sections.found})
    out.insert(out.end(), bytes->begin(), bytes->end());
  for (const Bytes* bytes : {&sections.records, &sections.found}) put_fixed(footer, uint64_t{bytes->size()}), put_fixed(footer, checksum(*bytes));
  put_fixed(footer, uint64_t{out.size() + 64});
  ContentHash hash;
  hash.add(sections.grid);
  for (const uint8_t byte : hash.digest()) footer.push_back(byte);
  put_fixed(footer, checksum(footer));
  out.insert(out.end(), footer.begin(), footer.end());
  return out;
}

}  // namespace teracell::testing
