"""The third set: 40 records with one mistake each. The list was written before any helper was chosen.

Inputs
 1. The module of a pair of diametral pitch 8 is entered as 3 mm.
 2. The pressure angle stays at the default of 20 degrees; the rack has 14.5 degrees.
 3. The speed of the gear shaft is entered as the speed of the pinion.
 4. The torque of the gear shaft is entered as the torque of the pinion.
 5. Young's modulus of steel is used for the gear of cast iron.
 6. The addendum coefficient stays at 1; the rack has long teeth.
 7. The viscosity of the cold oil, 40 degrees Celsius, is used.
Geometry
 8. The profile shift of the gear has the wrong sign.
 9. The tip circle of the pinion bounds the approach and that of the gear the recess.
10. The circular pitch is used in place of the base pitch: the overlap of the pairs is too short.
11. The pressure angle of the rack is used for the line of action of shifted teeth.
12. The moment arms of friction count from A, where contact starts.
Stiffness
13. The mean mesh stiffness c_gamma of ISO 6336 is used as the stiffness of each pair.
14. The end ratio of the parabola is used as its drop.
15. The parabola has its peak at the pitch point.
16. The mesh stiffness is cut after its first harmonic.
17. The compliance of Hertz is added to a stiffness that contains it.
18. Stiffness ramps up and down over a part of the path, as a correction against jumps.
19. The face width is that of the wider gear.
Damping
20. The effective mass of the damping is that of the two translating masses.
21. Damping in proportion to stiffness takes the natural frequency in Hz for rad/s.
22. The damping of bearings loses a factor of 1000 (N s/mm).
23. One constant mesh damping of the mean stiffness is given to every pair in contact.
Friction
24. The law of Benedict and Kelley has the natural logarithm.
25. The roughness is Rz, not Ra.
26. The friction moment on the gear is left out.
27. Friction reverses in the middle of the path, not at the pitch point.
Bodies
28. The flywheel effect GD2 is entered as the moment of inertia.
29. The inertia of the discs goes to the tip circle, and their mass too.
30. The bore of the gear is left out.
31. The inertia of the motor is lumped to the pinion.
Supports
32. The given stiffness is read as that of one of two bearings of a shaft: it is doubled.
33. Stiffness along and off the line of action are exchanged.
34. The bearings are left out; the file has soft ones.
35. The displacement of the gear along the line of action has the wrong sign in the approach.
Contact
36. The static transmission error is added as an error of the teeth to the stiffness that makes it.
37. Teeth pull at a speed at which contact is lost.
Integration and export
38. The implicit Euler method takes coarse steps.
39. The record begins a few cycles after the start from rest.
40. A low-pass filter of the recorder takes away the higher mesh orders of the bearing forces.
Seven more stand by for pairs of mistakes: dampers left out of bearing forces, the time axis of another sampling rate,
forces in pounds, transmission error without supports, a window left on, the factor 0.8 of ISO left out, friction on
both gears in the same direction, and a centre distance rounded to the one without backlash.
"""
