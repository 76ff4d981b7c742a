//! What the shapes of two neighbouring surfaces prove about the rays between them, so that tests that no ray can fail are
//! left out of the table. Two surfaces and their distance in; the [`Tests`] that remain out.
//!
//! A ray is turned back where its next surface lies behind it (t < 0) or it no longer travels
//! forward (Vz <= 0). It leaves a surface, and crosses the next one, toward the side ahead.

/// The part of a surface inside its clear aperture, in a frame at its vertex with the axis along the travel.
#[derive(Clone, Copy, Debug)]
pub struct ClearPart {
    /// 1/radius, positive when the centre lies ahead.
    pub curvature: f64,
    /// Clear semi-diameter.
    pub semi_diameter: f64,
    /// The least and the greatest z of a part that is neither a sphere's nor a plane's.
    pub aspheric: Option<[f64; 2]>,
}

/// Which tests a ray between two surfaces still needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tests {
    /// That it travels forward, Vz > 0.
    pub forward: bool,
    /// That the next surface lies ahead, t >= 0.
    pub onward: bool,
}

/// Gaps count from this part of the lengths involved, far above the rounding of single precision.
const MARGIN: f64 = 1e-5;

impl ClearPart {
    fn sagitta(self, height: f64) -> f64 {
        let c = self.curvature;
        c * height * height / (1.0 + (1.0 - (c * height).powi(2)).max(0.0).sqrt())
    }

    /// The least and the greatest z of the part.
    fn extent(self) -> [f64; 2] {
        if let Some(extent) = self.aspheric {
            return extent;
        }
        let edge_sagitta = self.sagitta(self.semi_diameter);
        [edge_sagitta.min(0.0), edge_sagitta.max(0.0)]
    }

    /// Whether the whole part, whose vertex lies `ahead` of the ball's, is inside the ball whose near
    /// pole is at the origin and whose centre lies on the same side; a half space where it is flat.
    fn is_inside(self, ball: f64, ahead: f64) -> bool {
        let (height, margin) = (self.semi_diameter, MARGIN * (self.semi_diameter + ahead));
        if !(ball * height < 1.0 && ball >= 0.0) {
            return false;
        }
        // The difference of two sagittae is monotonic in height, so that the edge and the vertex decide.
        let near = ClearPart { curvature: ball, semi_diameter: height, aspheric: None }.sagitta(height);
        let edge = ahead + self.sagitta(height);
        let inside_near = ahead > margin && edge > near + margin;
        let far = if ball > 0.0 { 2.0 / ball } else { f64::INFINITY };
        inside_near && ahead < far - margin && edge < far - near - margin
    }
}

/// The tests that rays need from the part `from` to the part `to`, whose vertex lies `distance` ahead.
pub fn tests(from: ClearPart, to: ClearPart, distance: f64) -> Tests {
    // A ray leaving `from` into a ball does not come from inside it, and so can meet what is inside
    // only ahead; seen backward, the same holds for the ball that it leaves at `to`.
    let reversed = ClearPart { curvature: -from.curvature, ..from };
    let both_balls = from.aspheric.or(to.aspheric).is_none();
    let inside = || to.is_inside(from.curvature, distance) || reversed.is_inside(-to.curvature, distance);
    let ahead = both_balls && inside();
    // Where every point of `to` lies ahead in z, t and Vz have the same sign.
    let apart = leaves_room(from, to, distance);
    Tests { forward: !(ahead && apart), onward: !(ahead || apart) }
}

/// Whether all of `to` lies farther along the axis than all of `from`.
fn leaves_room(from: ClearPart, to: ClearPart, distance: f64) -> bool {
    let margin = MARGIN * (from.semi_diameter + to.semi_diameter + distance);
    distance + to.extent()[0] > from.extent()[1] + margin
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clear_part(radius: f64, semi_diameter: f64) -> ClearPart {
        ClearPart { curvature: radius.recip(), semi_diameter, aspheric: None }
    }

    #[test]
    fn nothing_is_left_to_test_between_planes_and_in_a_thick_biconvex_element() {
        let none = Tests { forward: false, onward: false };
        let plane = ClearPart { curvature: 0.0, semi_diameter: 10.0, aspheric: None };
        assert_eq!(tests(plane, plane, 0.1), none);
        assert_eq!(tests(clear_part(20.0, 5.0), clear_part(-20.0, 5.0), 3.0), none);
    }

    #[test]
    fn a_meniscus_needs_the_direction_and_crossing_surfaces_both() {
        assert_eq!(
            tests(clear_part(20.0, 8.0), clear_part(22.0, 8.0), 1.0),
            Tests { forward: true, onward: false }
        );
        // The edges of a biconvex element that is too thin, and touching vertices.
        assert_eq!(
            tests(clear_part(20.0, 12.0), clear_part(-20.0, 12.0), 2.0),
            Tests { forward: true, onward: true }
        );
        assert_eq!(
            tests(clear_part(20.0, 8.0), clear_part(20.0, 8.0), 0.0),
            Tests { forward: true, onward: true }
        );
    }

    #[test]
    fn a_small_ball_proves_nothing_about_what_lies_beyond_it() {
        let beyond = tests(clear_part(1.0, 0.5), clear_part(-20.0, 4.0), 5.0);
        assert!(!tests(clear_part(1.0, 0.5), clear_part(-1.0, 0.5), 1.9).onward);
        assert!(beyond.forward || !beyond.onward);
        assert!(!clear_part(-20.0, 0.5).is_inside(1.0, 5.0));
        assert!(!clear_part(20.0, 4.0).is_inside(1.0, 0.5));
    }
}
