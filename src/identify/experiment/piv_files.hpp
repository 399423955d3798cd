#pragma once
#include "video/piv/piv_field.hpp"

namespace treacle::identify {

// The velocity fields of a file: of a text file one, of a PIVlab session (MATLAB 7.3) one a frame. PIVlab's arrays are
// x_0, y_0, u_0, v_0 and typevector_0 for each frame, or x, y, u, v and typevector for one; vectors of type 1 are measured,
// others masked or interpolated; calxy [m/px] and caluv [(m/s)/(px/frame)], both 1 where the session was not calibrated.
// InputError as read_piv_text.
std::vector<video::PivField> read_piv(const std::filesystem::path& path);

} // namespace treacle::identify
