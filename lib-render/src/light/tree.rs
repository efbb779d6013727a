//! A tree over many lights: which of them matters at a point (Conty Estevez and Kulla, "Importance sampling of many lights with
//! adaptive tree splitting", 2018).
//!
//! A node bounds its lights by a ball, by a cone of normals and by a largest angle to those in which light leaves, and knows their
//! power. From a point that bounds what arrives: power · cos θ' / distance², with θ' the smallest angle between a direction
//! of light and one to the point that the bounds allow; 0 where no light can come. A light is drawn by going down from the root,
//! each time to one of two children by its share of their bounds, and its probability is the product of these shares. For a
//! light that a ray has hit the same walk is led by the bits of [`Lights::TRAIL`] instead of by random numbers.
//!
//! Light from infinitely far away has no place in a tree. The table of lights has it last, and all of it together keeps its
//! share of the power.

use jerboa_ir::lang::{Block, Bool, F32, Row, U32};

use crate::core::rng::Rng;
use crate::core::vec::{Vec3, vec3};
use crate::light::choose_light;
use crate::schema::{LightChoice, LightTree, Lights, Settings, TREE_LEAF};

/// Where both children may give light, neither is drawn less often than this: what bounds promise may be in the shadow, and the
/// weight of what comes instead stays bounded.
const LEAST: f32 = 1.0 / 1024.0;
/// Largest bound, for points next to a light without extent.
const MOST: f32 = 1e30;

/// A light for a point, and its probability; 0 where no light can reach the point. Uses two numbers.
pub fn choose(b: &mut Block, rng: Rng, point: Vec3) -> (U32, F32) {
    let (u, rng) = rng.next();
    let share = tree_share();
    let near = |b: &mut Block| {
        let (light, p) = descend(b, point, |node, _, first| rng.of(node).lt(first));
        (light, p * share)
    };
    let far = |b: &mut Block| {
        let light = choose_light(b, u);
        (light, Row::<Lights>::at(light).get(Lights::PROBABILITY))
    };
    b.if_(u.lt(share), near, far)
}

/// The probability with which [`choose`] draws a light of the tree for a point: the same walk.
pub fn probability(b: &mut Block, light: U32, point: Vec3) -> F32 {
    let trail = Row::<Lights>::at(light).get(Lights::TRAIL);
    let (_, p) = descend(b, point, |_, level, _| ((trail >> level) & 1u32).eq(0u32));
    p * tree_share()
}

/// Probability of all lights that have a place.
fn tree_share() -> F32 {
    Row::at(Row::<Settings>::at(0u32).get(Settings::TREE_LIGHTS)).get(LightChoice::CDF)
}

/// From the root to a light: its row, and the product of the shares on the way. `is_first` says whether to go to the first
/// child, from node, level and that child's share.
fn descend(b: &mut Block, point: Vec3, is_first: impl Fn(U32, U32, F32) -> Bool) -> (U32, F32) {
    let link = |node: U32| Row::<LightTree>::at(node).get(LightTree::LINK);
    let go_on = |_: &mut Block, (node, _, p): (U32, U32, F32)| (link(node) & TREE_LEAF).eq(0u32) & p.gt(0.0);
    let step = |_: &mut Block, (node, level, p): (U32, U32, F32)| {
        let children = [node + 1u32, link(node)];
        let [one, other] = children.map(|child| importance(Row::at(child), point));
        let sum = one + other;
        let both = one.gt(0.0) & other.gt(0.0);
        let share = one / sum;
        let share = both.select(share.max(LEAST).min(1.0 - LEAST), share);
        let first = is_first(node, level, share);
        let drawn = sum.gt(0.0).select(first.select(share, 1.0 - share), F32::from(0.0));
        (first.select(children[0], children[1]), level + 1u32, p * drawn)
    };
    let (node, _, p) = b.while_((0.into(), 0.into(), 1.0.into()), go_on, step);
    (link(node) & !TREE_LEAF, p)
}

/// Bound on what arrives from the lights of a node, up to a factor that all nodes share.
fn importance(node: Row<LightTree>, point: Vec3) -> F32 {
    let get = |column| node.get(column);
    let to = point - vec3(get(LightTree::X), get(LightTree::Y), get(LightTree::Z));
    let axis = vec3(get(LightTree::AXIS_X), get(LightTree::AXIS_Y), get(LightTree::AXIS_Z));
    let radius = get(LightTree::RADIUS);
    let distance = to.length();
    let inside = distance.le(radius);
    // The angle to the axis, less that of the cone of normals, less that of the ball.
    let angle = Angle::of((axis.dot(to) / distance).max(-1.0).min(1.0));
    let ball = Angle::by_sin(radius / distance);
    let cone = Angle { cos: get(LightTree::COS_NORMALS), sin: get(LightTree::SIN_NORMALS) };
    let cos = inside.select(F32::from(1.0), angle.less(cone).less(ball).cos);
    let distance = distance.max(radius);
    let bound = (get(LightTree::POWER) * cos / distance / distance).min(MOST);
    cos.gt(get(LightTree::COS_LIGHT)).select(bound, F32::from(0.0))
}

/// An angle in [0, π].
#[derive(Clone, Copy)]
struct Angle {
    cos: F32,
    sin: F32,
}

impl Angle {
    fn of(cos: F32) -> Angle {
        Angle { cos, sin: (1.0 - cos * cos).max(0.0).sqrt() }
    }

    /// An acute one.
    fn by_sin(sin: F32) -> Angle {
        Angle { cos: (1.0 - sin * sin).max(0.0).sqrt(), sin }
    }

    /// The difference; 0 where it would be negative.
    fn less(self, o: Angle) -> Angle {
        let smaller = self.cos.gt(o.cos);
        Angle {
            cos: smaller.select(F32::from(1.0), self.cos * o.cos + self.sin * o.sin),
            sin: smaller.select(F32::from(0.0), self.sin * o.cos - self.cos * o.sin),
        }
    }
}
