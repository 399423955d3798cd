#include "identify/experiment/series.hpp"

#include "base/options/options.hpp"

namespace treacle::identify {

void Series::declare(Declaration& d) {
    if (d.parsing()) where = d.location();
    d.text("file", file,
        "CSV with columns time, value and plus_minus, each with its unit in brackets; plus_minus is a standard "
        "deviation.");
    d.required("file");
    d.text("values", values, "Name of the column with the values.");
    d.text(
        "measurement", measurement, "Name of the scene's measurement that they are: a front, a height, a flow rate.");
    d.text("table", table, "Or a table of the run, bodies or measurements, with");
    d.text("column", column, "its column, with its unit as in the header: ball position z [m].");
    d.number("offset", offset, unit::none, range_at_least(0),
        "Standard deviation of the instrument's zero, in the SI unit of the values.");
    if (!d.parsing()) return;
    d.check(measurement.empty() != table.empty(), "measurement",
        {"must be given, or a table with its column, and not both", "the values are compared with one of the run's",
            "write for instance measurement: front"});
    d.check(table.empty() || table == "bodies" || table == "measurements", "table",
        {"must be bodies or measurements", "a run's other tables are of its solver", ""});
    d.check(table.empty() || (column.find('[') != std::string::npos && column.ends_with("]")), "column",
        {"must be given with its unit", "the values are converted to it",
            "write for instance column: ball position z [m]"});
}

} // namespace treacle::identify
