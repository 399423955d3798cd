#pragma once
#include <string>
#include <vector>

namespace treacle::video {

// True time over time stamp, by straight pieces. Slow motion that a phone exports runs at normal speed at its
// ends and slowly between them.
class TimeMap {
public:
    TimeMap() = default; // the stamp itself

    // "0:0 2:2 10:3 12:5", stamp:time [s], both ascending, at least two; or a CSV file with columns stamp, time.
    // Stamps outside go on along the first or last piece. InputError for anything else.
    static TimeMap read(const std::string& text);
    // A clip of frames at a steady `file_rate`, shot at `true_rate`; the first frame keeps its stamp.
    static TimeMap slowed(double first_stamp, double file_rate, double true_rate);

    double at(double stamp) const;                    // [s] both; the first and last pieces go on beyond their ends
    bool identity() const { return stamps_.empty(); } // true for the default: the stamp is the time

private:
    std::vector<double> stamps_, times_;
};

} // namespace treacle::video
