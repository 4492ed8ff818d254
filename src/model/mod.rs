//! Models of an actuator: circuits, back-relaxation, the lumped electromechanical model.
