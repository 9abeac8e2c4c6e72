// Three pegs, three bores: a fit that may interfere, one that must, one that cannot, whose peg stands askew; and a block that touches nothing.
export const PEGS = `
name: pegs
units: mm
policy: stop
max_jump: 20
parts:
  - name: plate
    generator: {kind: plate_with_bore, bore: 20, facets: 32}
    instances:
      - {name: plate_k6, pose: {position: [0, 0, 0]}}
      - {name: plate_p6, pose: {position: [80, 0, 0]}}
      - {name: plate_g6, pose: {position: [160, 0, 0]}}
  - name: peg
    generator: {kind: dowel, diameter: 20, length: 40, chamfer: 1, facets: 32, phase_deg: 5.625}
    features:
      chamfer_lower: {tolerance: {lower: -0.1, upper: -0.04}}
      chamfer_upper: {tolerance: {lower: -0.1, upper: -0.04}}
    moving: true
    instances:
      - {name: peg_k6, pose: {position: [0, 0, 25]}}
      - {name: peg_p6, pose: {position: [80, 0, 25]}}
      - {name: peg_g6, pose: {position: [164, -3, 60]}}
  - {name: block, generator: {kind: block, x: 20, y: 20, z: 20}, moving: true, pose: {position: [-60, 0, 40]}}
  - {name: stray, generator: {kind: dowel, diameter: 20, length: 40, chamfer: 1, facets: 32}, moving: true,
     pose: {position: [3, 2, 72]}}
fits:
  - {between: [plate_k6.bore, peg_k6.journal], code: Ø20 H7/k6}
  - {between: [plate_p6.bore, peg_p6.journal], code: Ø20 H7/p6}
  - {between: [plate_g6.bore, peg_g6.journal], code: Ø20 H7/g6}
`;
