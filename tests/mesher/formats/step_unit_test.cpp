// The unit of length that a STEP file states.
#include "mesher/formats/step_unit.hpp"

#include "tests/support/test.hpp"

namespace teracell::mesher {
namespace {

const std::string kStart = "ISO-10303-21;\nHEADER;\nFILE_NAME('a','',(''),(''),'','','');\nENDSEC;\nDATA;\n", kEnd = "ENDSEC;\nEND-ISO-10303-21;\n";
const std::string kMilli = "#1=(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.));\n";

std::string si(const std::string& number, const std::string& prefix) {
  return '#' + number + "=(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(" + prefix + ",.METRE.));\n";
}
std::string converted(const std::string& number, const std::string& name) {
  return '#' + number + "=(CONVERSION_BASED_UNIT('" + name + "',#90) LENGTH_UNIT() NAMED_UNIT(#91));\n";
}
std::string context(const std::string& number, const std::string& unit) {
  return '#' + number + "=(GEOMETRIC_REPRESENTATION_CONTEXT(3) GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#80))\nGLOBAL_UNIT_ASSIGNED_CONTEXT((" + unit +
         ",#81,#82)) REPRESENTATION_CONTEXT('','3D'));\n";
}

std::string found(const std::string& data) {
  StepUnit unit;
  unit.feed(kStart + data + kEnd);
  return unit.found();
}

TEST_CASE("STEP: the unit is that of the first context, wherever the unit itself stands") {
  CHECK(found(kMilli + context("5", "#1")) == "mm");
  CHECK(found(context("5", "#1") + kMilli) == "mm");
  CHECK(found(kMilli + si("2", "$") + context("5", "#2") + context("6", "#1")) == "m");
  CHECK(found(context("5", "#2") + context("6", "#1") + kMilli + si("2", "$")) == "m");
  CHECK(found(context("5", "#11") + kMilli + si("11", ".CENTI.")) == "cm");
  CHECK(found(kMilli + context("5", "#81,#1")) == "mm");
}

TEST_CASE("STEP: contexts of three dimensions go before others") {
  const auto flat = [](std::string text) { return text.replace(text.find("(3)"), 3, "(2)"); };
  CHECK(found(kMilli + si("2", "$") + flat(context("5", "#2")) + context("6", "#1")) == "mm");
  CHECK(found(kMilli + si("2", "$") + context("5", "#2") + flat(context("6", "#1"))) == "m");
  CHECK(found(flat(context("5", "#2")) + context("6", "#1") + si("2", "$") + kMilli) == "mm");
  CHECK(found(kMilli + si("2", "$") + flat(context("5", "#2")) + flat(context("6", "#1"))) == "m");
}

TEST_CASE("STEP: metres with every prefix that has a name here, inches and feet by any of their names") {
  for (const auto& [prefix, unit] :
       {std::pair{"$", "m"}, {".CENTI.", "cm"}, {".MILLI.", "mm"}, {".MICRO.", "um"}, {".NANO.", "nm"}, {".KILO.", ""}, {".DECI.", ""}}) {
    INFO(prefix);
    CHECK(found(si("1", prefix) + context("5", "#1")) == unit);
  }
  for (const auto& [name, unit] : {std::pair{"INCH", "in"},
                                   {"inch", "in"},
                                   {"Inch", "in"},
                                   {"IN", "in"},
                                   {"FOOT", "ft"},
                                   {"feet", "ft"},
                                   {"FT", "ft"},
                                   {"MILE", ""},
                                   {"INCHES OF WATER", ""},
                                   {"", ""}}) {
    INFO(name);
    CHECK(found(converted("1", name) + context("5", "#1")) == unit);
  }
}

TEST_CASE("STEP: an order and blanks of another writer don't matter to the unit") {
  CHECK(found("#1 = ( NAMED_UNIT ( * ) LENGTH_UNIT ( ) SI_UNIT ( .MILLI. , .METRE. ) ) ;\n#2 = ( GLOBAL_UNIT_ASSIGNED_CONTEXT ( ( #1 ) ) ) ;\n") ==
        "mm");
  CHECK(found("#1=(SI_UNIT(.MILLI.,.METRE.)LENGTH_UNIT()NAMED_UNIT(*));#2=(GLOBAL_UNIT_ASSIGNED_CONTEXT((#1)));") == "mm");
  CHECK(found("#1=(LENGTH_UNIT()\r\n\tNAMED_UNIT(*)\r\n\tSI_UNIT(.MILLI.,\r\n\t.METRE.));\r\n" + context("2", "#1")) == "mm");
  CHECK(found("#1=(CONVERSION_BASED_UNIT ( 'INCH' ,#9)LENGTH_UNIT()NAMED_UNIT(#8));" + context("2", "#1")) == "in");
}

TEST_CASE("STEP: what stands in comments and in quotes states no unit") {
  const std::string metres = si("2", "$") + context("6", "#2"), inches = converted("1", "INCH") + context("5", "#1");
  CHECK(found("/* " + metres + " */" + inches) == "in");
  CHECK(found("/**/" + inches) == "in");
  CHECK(found("/***/" + inches) == "in");
  CHECK(found("/* one ' quote */" + inches) == "in");
  CHECK(found("#7=PRODUCT('" + metres + "','',$,());\n" + inches) == "in");
  CHECK(found("#7=PRODUCT('a''b;#3=(/*','it''s',$,());\n" + inches) == "in");
  CHECK(found("#7=PRODUCT('/*','',$,());\n" + inches) == "in");
  CHECK(found("#7=PRODUCT('''','',$,());\n" + inches) == "in");
  CHECK(found("#1=/*;*/(LENGTH_UNIT()/* ' */NAMED_UNIT(*)SI_UNIT(.MILLI.,/*#5*/.METRE.));" + context("5", "#1")) == "mm");
}

TEST_CASE("STEP: names that read like units and contexts are neither") {
  const std::string inches = converted("1", "INCH") + context("5", "#1");
  CHECK(found("#7=PRODUCT('LENGTH_UNIT() SI_UNIT(.NANO.,.METRE.)','',$,());\n#8=PRODUCT('GLOBAL_UNIT_ASSIGNED_CONTEXT((#7))','',$,());\n" + inches) ==
        "in");
  CHECK(found("#1=(CONVERSION_BASED_UNIT('INCH',#90) LENGTH_UNIT() NAMED_UNIT(#91));\n#8=PRODUCT('GLOBAL_UNIT_ASSIGNED_CONTEXT((#2))','',$,());\n" +
              si("2", "$") + context("5", "#1")) == "in");
}

TEST_CASE("STEP: a file without a unit of length, or with one of no name, states none") {
  CHECK(found("").empty());
  CHECK(found(kMilli).empty());
  CHECK(found(context("5", "#1")).empty());
  CHECK(found("#1=(NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.));\n" + context("5", "#1")).empty());
  CHECK(found(si("1", ".KILO.") + context("5", "#1")).empty());
  StepUnit unit;
  CHECK(unit.feed(""));
  CHECK(unit.feed("#1=(LENGTH_UNIT()"));
  CHECK(unit.found().empty());
}

TEST_CASE("STEP: the unit doesn't depend on where the bytes are split, and no more are wanted once it is known") {
  const std::string text =
      kStart + "#7=PRODUCT('it''s; /* #1','',$,());/* ;'#2 **/\n" + si("2", "$") + context("5", "#1") + converted("1", "INCH") + kEnd;
  for (size_t i = 0; i <= text.size(); ++i) {
    StepUnit unit;
    unit.feed(text.substr(0, i));
    unit.feed(text.substr(i));
    INFO(i);
    REQUIRE(unit.found() == "in");
  }
  StepUnit unit;
  size_t wanted = 0;
  while (unit.feed({&text[wanted], 1})) ++wanted;
  CHECK(unit.found() == "in");
  CHECK(wanted == text.size() - kEnd.size() - 2);  // the last ';', and a line's end
  CHECK_FALSE(unit.feed(kMilli));
  CHECK(unit.found() == "in");
}

TEST_CASE("STEP: an entity of many megabytes and units without number leave the unit found") {
  const std::string inches = converted("1", "INCH") + context("5", "#1");
  CHECK(found("#7=A('" + std::string(4'000'000, ' ') + "');\n#8=A(" + std::string(4'000'000, '(') + ");\n" + inches) == "in");
  CHECK(found("#99999999999999999999999999999999=A();\n" + inches) == "in");
  std::string many;
  for (int i = 100; i < 3000; ++i) many += si(std::to_string(i), ".MILLI.");
  CHECK(found(many + inches) == "in");
}

}  // namespace
}  // namespace teracell::mesher
