use handc_runtime::interpreter::Interpreter;
use handc_core::model::Model;
use std::sync::Arc;
fn main() {
    let file = std::env::args().nth(1).unwrap();
    let m = handc_tests::load::mechanism(std::path::Path::new(&file)).unwrap();
    let n = m.coordinates.len();
    let mut free = m.clone();
    for s in &mut free.strands { for w in &mut s.wraps { w.radius = handc_runtime::mechanism::Number::Constant(1e-9); w.side = None; } }
    let (mut i, mut f) = (Interpreter::new(Arc::new(m.clone())), Interpreter::new(Arc::new(free)));
    let (mut q, mut v) = (vec![0.0; n], vec![0.0; n]);
    i.start(&mut q, &mut v);
    let mut seed = 7u64;
    for k in 0..4 {
        let (mut a, mut b) = (vec![0.0; m.strands.len()], vec![0.0; m.strands.len()]);
        i.strand_lengths(&q, &mut a); f.strand_lengths(&q, &mut b);
        let mut arms = vec![0.0; n * m.strands.len()];
        i.moment_arms(&q, &mut arms);
        println!("pose {k}");
        let poses = i.link_poses(&q);
        let numbers = handc_runtime::resolved::Resolved::<f64>::new(&m, i.params());
        for strand in &m.strands { for w in &strand.wraps {
            let place = |p: &handc_runtime::mechanism::Point| { let x = numbers.vector(&p.position); p.link.map_or(x, |l| poses[l as usize].point(x)) };
            let (a, b) = (place(&strand.points[w.gap as usize]), place(&strand.points[w.gap as usize + 1]));
            let back = |x| w.center.link.map_or(x, |l: u32| poses[l as usize].inverse_point(x));
            let c = numbers.vector(&w.center.position);
            let (a, b) = (back(a) - c, back(b) - c);
            println!("   {} {} P {:.3?} Q {:.3?} mid {:.3?}", strand.name, w.source, a.0, b.0, (a+b).scale(0.5).0);
        }}
        for (s, strand) in m.strands.iter().enumerate() {
            println!("{:10} {:.6} {:.3e}  {:?}", strand.name, a[s], a[s] - b[s], arms[s*n..(s+1)*n].iter().map(|x| format!("{x:.3e}")).collect::<Vec<_>>());
        }
        for (c, x) in m.coordinates.iter().zip(&mut q) {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let r = (seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0;
            let Some(start) = (match c.start { handc_runtime::mechanism::Number::Constant(x) => Some(x), _ => None }) else { continue };
            *x = start + r * if c.is_length { 0.03 } else { 0.4 };
        }
    }
}
