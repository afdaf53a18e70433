//! try
fn main() {
    let env =
        firmware_sim::bridge::environment::ensure(firmware_sim::progress::Audience::Log).unwrap();
    for t in ["drawer-open-v3", "reach-v3", "box-close-v3"] {
        let s = firmware_sim::bridge::speed::measure(&env, t, 2000).unwrap();
        println!("{t} {s:?} {:.3}", s.share());
    }
}
