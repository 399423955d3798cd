#include "video/clip/time_map.hpp"

#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "video/picture/number_table.hpp"

#include <algorithm>
#include <filesystem>
#include <sstream>

namespace treacle::video {

namespace {
InputError refuse(const std::string& text, const std::string& problem) {
    return InputError({"--time-map " + shorten(text), problem,
        "each point is a time stamp of the file and the true time there, both in seconds",
        "write for instance \"0:0 2:2 10:3 12:5\", or name a CSV file with columns stamp and time"});
}
} // namespace

TimeMap TimeMap::read(const std::string& text) {
    TimeMap map;
    if (std::filesystem::is_regular_file(text)) {
        const NumberTable table(text);
        map.stamps_ = table.column("stamp", unit::time);
        map.times_ = table.column("time", unit::time);
    } else {
        std::istringstream words(text);
        for (std::string word; words >> word;) {
            const auto colon = word.find(':');
            if (colon == std::string::npos) throw refuse(text, word + " is no point of a time map");
            const auto stamp = read_number(std::string_view(word).substr(0, colon));
            const auto time = read_number(std::string_view(word).substr(colon + 1));
            if (!stamp || !time) throw refuse(text, word + " is no point of a time map");
            map.stamps_.push_back(*stamp);
            map.times_.push_back(*time);
        }
    }
    if (map.stamps_.size() < 2) throw refuse(text, "has fewer than two points");
    const auto falls = [](const std::vector<double>& x) {
        return std::ranges::adjacent_find(x, [](double a, double b) { return !(a < b); }) != x.end();
    };
    if (falls(map.stamps_) || falls(map.times_)) throw refuse(text, "does not ascend");
    return map;
}

TimeMap TimeMap::slowed(double first_stamp, double file_rate, double true_rate) {
    TimeMap map;
    map.stamps_ = {first_stamp, first_stamp + 1};
    map.times_ = {first_stamp, first_stamp + file_rate / true_rate};
    return map;
}

double TimeMap::at(double stamp) const {
    if (identity()) return stamp;
    const auto above = std::ranges::upper_bound(stamps_, stamp) - stamps_.begin();
    const auto i = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(above - 1, 0, std::ssize(stamps_) - 2));
    const double part = (stamp - stamps_[i]) / (stamps_[i + 1] - stamps_[i]);
    return times_[i] + part * (times_[i + 1] - times_[i]);
}

} // namespace treacle::video
